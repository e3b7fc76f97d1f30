#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "engine/collide/slide.h"
#include "engine/math/pose.h"
#include "engine/rigid/joint.h"
#include "engine/rigid/looked_at.h"
#include "engine/rigid/mass_properties.h"

namespace condyle {

// Units: mm, s, kg, N. Energy N mm (mJ), momentum kg mm/s. Whatever is not finite or beyond its
// range is refused with an InputError that names the value.

struct RigidMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the centre of mass, world, mm/s
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();      // world, rad/s
};

struct RigidBody {
  MassProperties mass = {};  // mass 0: fixed, or carried along by its motion whatever pushes it
  Pose X_WB = {};
  RigidMotion motion = {};
  std::vector<std::shared_ptr<const SlideBody>> surfaces = {};  // body coordinates; may be none
  double drag_N_s_mm = 0;          // force against the velocity of the place it acts at
  double turning_drag_N_mm_s = 0;  // torque against its spin
  std::optional<Eigen::Vector3d> drag_at = {};  // body coordinates; else the centre of mass
};

/// A constant force until it is set anew.
struct RigidForce {
  int body = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // body coordinates, mm
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_N_mm = Eigen::Vector3d::Zero();
  enum class Frame { world, body } frame = Frame::world;  // of force and torque
};

/// A spring with a damper between two points; both resist along the line between them.
struct RigidSpring {
  int a = 0, b = 0;  // bodies
  Eigen::Vector3d p_A = Eigen::Vector3d::Zero(), p_B = Eigen::Vector3d::Zero();
  double rest_length_mm = 0;
  double stiffness_N_mm = 0;
  double damping_N_s_mm = 0;
  bool slack_when_short = false;  // a ligament: pulls only
};

/// Two bodies whose surfaces may touch but not overlap.
struct RigidPair {
  int a = 0, b = 0;
  double friction = 0.2;  // Coulomb coefficient
  double gap_mm = 0;      // kept between the surfaces: a disc; negative: they may overlap so far
};

struct RigidSettings {
  double step_s = 1e-3;
  Eigen::Vector3d gravity_mm_s2 = {0, 0, -9810};
  double slop_mm = 0.02;         // depth at which contacts rest
  int max_contacts = 64;         // of a pair, that push at once
  double thinning_mm = 1;        // between contacts that join together
  double push_out_mm_s = 20;     // how fast overlap is parted at most; adds no energy
  int max_sweeps = 60;           // of the constraint solver in a step
  double tolerance_mm_s = 1e-6;  // of the velocities it leaves at joints and contacts
  double max_speed_mm_s = 2e4;   // of any point; a step that would exceed it is not taken
};

/// One place where two bodies push each other.
struct RigidContact {
  int pair = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       // world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     // unit, from A to B
  double gap_mm = 0;                                     // negative: depth
  double push_N = 0;                                     // along the normal, on B
  Eigen::Vector3d friction_N = Eigen::Vector3d::Zero();  // on B
};

/// Everything that a step goes on from: the same state and input give the same bits.
struct RigidState {
  struct Body {
    Pose X_WB;
    RigidMotion motion;
  };
  struct Touch {  // a contact that pushed: where the solver starts from
    int look = 0, sample = 0;
    Eigen::Vector3d force_N = Eigen::Vector3d::Zero();  // on B, world
  };
  double time_s = 0;
  std::vector<Body> bodies;
  std::vector<Touch> touches;
  std::vector<double> joint_forces_N;  // of each joint's rows
  std::vector<LookedAt> looked_at;     // of each pair of surfaces, both ways
};

/// Rigid bodies with mass, forces, joints and contact, in steps of a fixed length. Contacts are
/// surface samples of one body in the distance field of the other: overlap beyond the fields' band
/// is not felt. Impacts are plastic: contact never adds energy. Nothing sleeps.
class RigidWorld {
 public:
  explicit RigidWorld(const RigidSettings& settings = {});
  ~RigidWorld();
  RigidWorld(RigidWorld&&) noexcept;

  /// Each gives the number of what it added, from 0 on.
  int add_body(const RigidBody& body);
  int add_force(const RigidForce& force);
  int add_spring(const RigidSpring& spring);
  int add_joint(const RigidJoint& joint);
  int add_pair(const RigidPair& pair);

  /// Overlap at the present poses is allowed to this pair from now on, sample by sample. Samples
  /// within `around_mm` of one that overlaps now are no longer felt at all.
  void allow_overlap(int pair, double around_mm = 0);

  void set_force(int force, const Eigen::Vector3d& force_N);
  void set_pose(int body, const Pose& X_WB);  // a jump; its motion stays
  void set_motion(int body, const RigidMotion& motion);

  /// One step of settings().step_s, divided where bodies near each other are fast. Not taken, and
  /// nothing changed, when something would go faster than allowed or not be finite.
  struct Step {
    bool taken = true;
    int parts = 1;              // it was divided into
    int sweeps = 0;             // of the solver, in all
    double joint_error_mm = 0;  // largest before the step
    double depth_mm = 0;        // largest before the step, beyond what is allowed
  };
  Step step(int threads = 1);

  const RigidSettings& settings() const;
  int body_count() const;
  const Pose& pose(int body) const;
  const RigidMotion& motion(int body) const;
  const MassProperties& mass(int body) const;
  RigidState state() const;
  void set_state(const RigidState& state);  // of a world built alike

  /// What pushed in the last step.
  const std::vector<RigidContact>& contacts() const;

  double kinetic_energy() const;    // of the free bodies
  double potential_energy() const;  // of gravity (0 at the origin's height) and springs
  Eigen::Vector3d momentum() const;
  Eigen::Vector3d angular_momentum() const;  // about the origin, kg mm^2/s

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
