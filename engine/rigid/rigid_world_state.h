#pragma once

#include <Eigen/Core>
#include <concepts>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "engine/rigid/constraint_solver.h"
#include "engine/rigid/contact_finder.h"
#include "engine/rigid/joint_rows.h"
#include "engine/rigid/rigid_world.h"

namespace condyle {

constexpr double force_limit_N = 1e5;

inline void require(bool good, const std::string& problem) {
  if (!good) throw InputError("dynamics: " + problem);
}

/// The same for what is called in every step: the problem is described only where there is one.
template <std::invocable Problem>
void require(bool good, const Problem& problem) {
  if (!good) require(false, problem());
}

/// The objects of a world and the stages of a step (rigid_step.cpp).
struct RigidWorld::State : ContactGenerator {
  /// A body with quantities derived from its mass.
  struct Member {
    DynamicBody body;  // pose and motion are the initial ones
    int solver = -1;
    Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();  // body coordinates
    Eigen::Matrix3d principal = Eigen::Matrix3d::Identity();    // axes, body coordinates
    double max_inverse_moment = 0;                              // largest 1 / principal moment
    double radius_mm = 0;  // of the surfaces about the centre of mass
  };

  RigidSettings settings;
  std::vector<Member> members;
  std::vector<RigidForce> forces;
  std::vector<RigidSpring> springs;
  std::vector<JointRows> joints;
  std::vector<int> rows_of;
  std::vector<RigidPair> pairs;
  ContactFinder finder;
  ConstraintSolver solver;

  double time_s = 0;
  std::vector<RigidMotion> motions;
  std::vector<Pose> poses;
  std::vector<RigidState::ContactForce> memory;
  std::vector<double> joint_forces;
  std::vector<RigidContact> contacts;

  // Work space of a step.
  double part_s = 0;
  std::vector<Eigen::Vector3d> centers;
  std::vector<SolverMotion> body_motions;  // of all bodies
  std::vector<SolverBody> solver_bodies;
  std::vector<SolverMotion> solved, shifts;
  std::vector<JointRow> joint_rows;
  std::vector<double> start_impulses;
  std::vector<ContactConstraint> constraints;
  std::vector<int> point_of_constraint;
  std::vector<SurfaceContact> contact_points;
  std::vector<char> added;
  std::vector<int> constraints_of_pair;
  struct Violator {
    double depth = 0;
    int contact = 0;
    double apart2 = 0;  // squared distance to the contacts added with it
  };
  std::vector<Violator> violators;
  RigidState before;
  std::vector<RigidContact> contacts_before;

  std::size_t count() const { return members.size(); }
  Eigen::Vector3d center(std::size_t i) const { return poses[i] * members[i].body.mass.center; }
  bool is_free(std::size_t i) const { return members[i].solver >= 0; }

  void check_body(int body) const {
    require(body >= 0 && body < static_cast<int>(count()),
            [&] { return "there is no body " + std::to_string(body); });
  }
  static void check_pose(const Pose& X_WB) {
    require(X_WB.t.allFinite() && std::abs(X_WB.R.norm() - 1) < 1e-6,
            [] { return std::string("a pose is not finite or its rotation not of unit length"); });
  }
  void check_motion(const RigidMotion& motion, double radius_mm) const {
    const double speed = motion.velocity.norm() + motion.spin.norm() * radius_mm;
    require(speed <= settings.max_speed_mm_s, [&] {
      return "a motion of " + std::to_string(speed) + " mm/s is not finite or above " +
             std::to_string(settings.max_speed_mm_s);
    });
  }
  static void check_force(const Eigen::Vector3d& force_N) {
    require(force_N.norm() <= force_limit_N, "a force of " + std::to_string(force_N.norm()) +
                                                 " N is not finite or above " +
                                                 std::to_string(force_limit_N));
  }
  /// Mobility of a body at a point: largest velocity due to a unit impulse there.
  double mobility(int body, const Eigen::Vector3d& p_B) const {
    const Member& m = members[static_cast<std::size_t>(body)];
    if (m.solver < 0) return 0;
    return 1 / m.body.mass.mass_kg +
           (p_B - m.body.mass.center).squaredNorm() * m.max_inverse_moment;
  }

  void collect_forces();
  void add_spring_forces(const RigidSpring& spring);
  void prepare_joints(RigidWorld::Step& result);
  void warm_start_contacts();
  void add_constraint(int contact, const Eigen::Vector3d& impulse,
                      std::vector<ContactConstraint>& rows);
  bool add_new(std::span<const SolverMotion> free, std::vector<ContactConstraint>& rows) override;
  void pick(std::size_t first, std::size_t last, std::vector<ContactConstraint>& rows);
  bool advance(double step_s, int halvings, int threads, RigidWorld::Step& result);
  void integrate();
  void remember();
  RigidState save() const;
  void load(const RigidState& state);
};

}  // namespace condyle
