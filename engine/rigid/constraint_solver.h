#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

namespace condyle {

// The velocity problem of one step: impulses that satisfy joints and contacts. Units: kg, mm, s;
// impulses kg mm/s (a newton is 1000 kg mm/s^2). Only free bodies take part, numbered in order of
// addition; -1 stands for a body that is not free.

struct SolverMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the centre of mass
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
};

struct SolverBody {
  Eigen::Matrix3d R_WP = Eigen::Matrix3d::Identity();  // principal axes
  SolverMotion motion;
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
};

/// One constrained direction of a joint: along . (v_b - v_a) + turn_b . spin_b - turn_a . spin_a
/// becomes `target_velocity`, or at least that where the impulse is limited to one sign.
struct JointRow {
  int a = -1, b = -1;
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_a = Eigen::Vector3d::Zero(), turn_b = Eigen::Vector3d::Zero();
  double target_velocity = 0;
  double error = 0;          // position error in this direction, to be corrected
  double low = 0, high = 0;  // limits of the impulse
  double impulse = 0;        // in: initial value; out: result
};

/// One contact constraint; its normal points from A to B.
struct ContactConstraint {
  int a = -1, b = -1;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d arm_a = Eigen::Vector3d::Zero(), arm_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d carried = Eigen::Vector3d::Zero();  // prescribed relative velocity, B minus A, of
                                                      // bodies that are not free
  double gap = 0;   // mm that may close in this step; negative: penetration depth
  double part = 0;  // mm of penetration to be corrected in this step
  double friction = 0;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // on B; in: initial value; out: result
};

/// Source of contacts that are not yet part of the problem.
class ContactGenerator {
 public:
  virtual ~ContactGenerator() = default;
  /// Appends constraints of the contacts that would penetrate after a step with these motions;
  /// false: none.
  virtual bool add_new(std::span<const SolverMotion> motions,
                       std::vector<ContactConstraint>& rows) = 0;
};

struct SolverSettings {
  double step_s = 1e-3;
  int max_sweeps = 60;
  double tolerance = 1e-6;   // mm/s
  double max_impulse = 1e5;  // of a contact
  double undone = 0.3;       // fraction of the joints' position errors that a step corrects
};

/// Sequential impulses on Bullet's bodies and solver. Joints are typed constraints of Bullet;
/// contacts are solved between its sweeps with a friction cone that follows the normal impulse of
/// the same sweep. Position errors are corrected by displacements that are separate from the
/// velocities, so they add no energy.
class ConstraintSolver {
 public:
  ConstraintSolver();
  ~ConstraintSolver();

  void add_body(double mass_kg, const Eigen::Vector3d& principal_inertia);

  /// `joints`: the rows of a joint are consecutive; rows_of[j] is their number. `bodies` (input),
  /// `motions` and `shifts` (output; mm and rad) have one entry per free body. Returns the number
  /// of sweeps.
  int solve(const SolverSettings& settings, std::span<const SolverBody> bodies,
            std::vector<JointRow>& joints, std::span<const int> rows_of,
            std::vector<ContactConstraint>& constraints, ContactGenerator& more,
            std::vector<SolverMotion>& motions, std::vector<SolverMotion>& shifts);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
