#pragma once

#include <Eigen/Core>
#include <vector>

namespace condyle {

/// A small motion of a body: translation of its pivot (mm), then its rotation vector times a length
/// (rad * mm), so that both parts weigh alike.
using Twist = Eigen::Matrix<double, 6, 1>;

/// What a motion x does to one contact: its gap becomes gap_mm + along.dot(x), which must not fall
/// below zero.
struct ContactRow {
  Twist along = Twist::Zero();
  double gap_mm = 0;                                  // negative: too deep
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();      // from the pivot to the contact
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of the fixed body
  bool rubs = false;                                  // friction acts on it
};

/// Row of a contact whose gap grows with the motion of its point along `gradient`.
ContactRow contact_row(const Eigen::Vector3d& arm, const Eigen::Vector3d& gradient, double gap_mm,
                       double rotation_length_mm);

struct TwistSettings {
  double friction = 0;            // Coulomb coefficient
  double rotation_length_mm = 1;  // of the twists
  int max_contacts = 64;          // that push at once
  double thinning_mm = 1;         // between contacts that join together
  double tolerance_mm = 1e-3;     // of the gaps
};

struct Push {
  int row = 0;
  double length_mm = 0;  // how far it moves the twist along its normal
};

struct TwistSolution {
  Twist x = Twist::Zero();
  std::vector<Push> pushes;  // contacts that hold the body, in the order in which they joined
  double violation_mm = 0;   // largest gap below zero that is left
};

/// The motion nearest to `wanted` that keeps every gap open. Contacts join a few at a time, the
/// worst first; those that joined are solved by projected Gauss-Seidel. With friction each pushing
/// contact holds its point back sideways by at most friction times its push.
TwistSolution nearest_allowed(const Twist& wanted, const std::vector<ContactRow>& rows,
                              const TwistSettings& settings);

}  // namespace condyle
