#pragma once

#include <Eigen/Core>
#include <vector>

namespace condyle {

/// A small motion of a body: translation of its pivot (mm), then its rotation vector times a length
/// (rad * mm), which gives both parts comparable weights.
using Twist = Eigen::Matrix<double, 6, 1>;

/// Linear constraint of one contact: a motion x changes its gap to gap_mm + along.dot(x), which
/// must not be negative.
struct ContactRow {
  Twist along = Twist::Zero();
  double gap_mm = 0;                                  // negative: overlap
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();      // from the pivot to the contact
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of the fixed body
  bool rubs = false;                                  // friction acts at the contact
};

/// Constraint of a contact whose gap has this gradient with respect to the motion of its point.
ContactRow contact_row(const Eigen::Vector3d& arm, const Eigen::Vector3d& gradient, double gap_mm,
                       double rotation_length_mm);

struct TwistSettings {
  double friction = 0;            // Coulomb coefficient
  double rotation_length_mm = 1;  // scales the rotation of twists
  int max_contacts = 64;          // active at the same time
  double thinning_mm = 1;         // least distance between contacts that are activated together
  double tolerance_mm = 1e-3;     // of the gaps
};

struct Push {
  int row = 0;
  double length_mm = 0;  // displacement of the twist along its normal
};

struct TwistSolution {
  Twist x = Twist::Zero();
  std::vector<Push> pushes;  // active contacts, in the order of activation
  double violation_mm = 0;   // largest remaining penetration
};

/// The motion nearest to `requested` that keeps every gap non-negative. Contacts are activated a
/// few at a time, the worst first; the active ones are solved by projected Gauss-Seidel. With
/// friction each active contact opposes the tangential motion of its point by at most the friction
/// coefficient times its normal displacement.
TwistSolution nearest_allowed(const Twist& requested, const std::vector<ContactRow>& rows,
                              const TwistSettings& settings);

}  // namespace condyle
