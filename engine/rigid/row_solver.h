#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

namespace condyle {

// The velocity problem of one step: what impulses keep joints together and contacts apart. Units:
// kg, mm, s; impulses kg mm/s (a newton is 1000 kg mm/s^2). Only free bodies take part, numbered in
// the order in which they were added; -1 is a body that is not free.

struct SolverMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the centre of mass
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
};

struct SolverBody {
  Eigen::Matrix3d R_WP = Eigen::Matrix3d::Identity();  // principal axes
  SolverMotion motion;
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
};

/// One direction that a joint holds: along . (v_b - v_a) + turn_b . spin_b - turn_a . spin_a
/// becomes `wanted`, or no smaller where the impulse has only one sign.
struct JointRow {
  int a = -1, b = -1;
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_a = Eigen::Vector3d::Zero(), turn_b = Eigen::Vector3d::Zero();
  double wanted = 0;
  double error = 0;          // of the pose in this direction, to be undone
  double low = 0, high = 0;  // of the impulse
  double impulse = 0;        // in: to start from; out
};

/// One contact; its normal points from A to B.
struct PushRow {
  int a = -1, b = -1;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d arm_a = Eigen::Vector3d::Zero(), arm_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d carried = Eigen::Vector3d::Zero();  // velocity, B less A, of those not free
  double gap = 0;   // mm that may be closed in this step, or depth
  double part = 0;  // mm of depth to be parted in this step
  double friction = 0;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // on B; in: to start from; out
};

/// Contacts that the solver does not know yet.
class MoreContacts {
 public:
  virtual ~MoreContacts() = default;
  /// Appends rows of those that would overlap after a step with these motions; false: none.
  virtual bool join(std::span<const SolverMotion> motions, std::vector<PushRow>& rows) = 0;
};

struct SolverSettings {
  double step_s = 1e-3;
  int max_sweeps = 60;
  double tolerance = 1e-6;   // mm/s
  double max_impulse = 1e5;  // of a contact
  double undone = 0.3;       // share of the joints' errors that a step undoes
};

/// Bullet's bodies and its sequential impulse solver. Joints are typed constraints of Bullet;
/// contacts are solved between its sweeps with a friction cone tied to the normal impulse of the
/// same sweep. Errors of poses are undone by shifts apart from the velocities: no energy comes from
/// them.
class RowSolver {
 public:
  RowSolver();
  ~RowSolver();

  void add_body(double mass_kg, const Eigen::Vector3d& principal_inertia);

  /// `joints`: rows of one joint follow each other; rows_of[j] is their number. In `bodies` and
  /// out in `motions` and `shifts` (mm and rad): one for each free body. Gives the sweeps taken.
  int solve(const SolverSettings& settings, std::span<const SolverBody> bodies,
            std::vector<JointRow>& joints, std::span<const int> rows_of,
            std::vector<PushRow>& pushes, MoreContacts& more, std::vector<SolverMotion>& motions,
            std::vector<SolverMotion>& shifts);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
