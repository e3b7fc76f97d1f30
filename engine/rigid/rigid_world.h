#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "engine/collide/slide.h"
#include "engine/math/pose.h"
#include "engine/rigid/joint.h"
#include "engine/rigid/mass_properties.h"
#include "engine/rigid/sample_cache.h"

namespace condyle {

// Units: mm, s, kg, N. Energy N mm (mJ), momentum kg mm/s. throws: InputError with the value, for
// every argument that is not finite or out of range.

struct RigidMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the centre of mass, world, mm/s
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();      // world, rad/s
};

struct DynamicBody {
  MassProperties mass = {};  // mass 0: fixed, or moving as prescribed regardless of forces
  Pose X_WB = {};
  RigidMotion motion = {};
  std::vector<std::shared_ptr<const ContactSurface>> surfaces =
      {};                                       // body coordinates; may be none
  double drag_N_s_mm = 0;                       // force against the velocity of its point of action
  double turning_drag_N_mm_s = 0;               // torque against its spin
  std::optional<Eigen::Vector3d> drag_at = {};  // body coordinates; else the centre of mass
};

/// A force that is constant until set again.
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

/// Two bodies in contact: their surfaces must not overlap.
struct RigidPair {
  int a = 0, b = 0;
  double friction = 0.2;  // Coulomb coefficient
  double gap_mm = 0;      // kept between the surfaces (as by a disc); negative: allowed overlap
};

struct RigidSettings {
  double step_s = 1e-3;
  Eigen::Vector3d gravity_mm_s2 = {0, 0, -9810};
  double slop_mm = 0.02;           // penetration depth of resting contacts
  int max_contacts = 64;           // per pair, active at the same time
  double thinning_mm = 1;          // least distance between contacts added together
  double depenetration_mm_s = 20;  // largest speed of depenetration; adds no energy
  int max_sweeps = 60;             // of the constraint solver in a step
  double tolerance_mm_s = 1e-6;    // of the remaining velocity errors at joints and contacts
  double max_speed_mm_s = 2e4;     // of any point; a step that would exceed it is not taken
};

/// A contact force between two bodies.
struct RigidContact {
  int pair = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       // world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     // unit, from A to B
  double gap_mm = 0;                                     // negative: depth
  double push_N = 0;                                     // along the normal, on B
  Eigen::Vector3d friction_N = Eigen::Vector3d::Zero();  // on B
};

/// The complete state between steps: the same state and input give bit-identical results.
struct RigidState {
  struct Body {
    Pose X_WB;
    RigidMotion motion;
  };
  struct ContactForce {  // the force of a contact: initial value of the solver
    int query = 0, sample = 0;
    Eigen::Vector3d force_N = Eigen::Vector3d::Zero();  // on B, world
  };
  double time_s = 0;
  std::vector<Body> bodies;
  std::vector<ContactForce> contact_forces;
  std::vector<double> joint_forces_N;         // per constraint row of the joints
  std::vector<SampleCacheKey> sample_caches;  // per pair of surfaces, in both directions
};

/// Dynamics of rigid bodies with mass, forces, joints and contact, with a fixed time step. Contacts
/// are surface samples of one body in the distance field of the other: overlap beyond the band of
/// the fields is not detected. Impacts are perfectly inelastic: contact never adds energy. Bodies
/// are never put to sleep.
class RigidWorld {
 public:
  explicit RigidWorld(const RigidSettings& settings = {});
  ~RigidWorld();
  RigidWorld(RigidWorld&&) noexcept;

  /// Each returns the index of the added object, from 0.
  int add_body(const DynamicBody& body);
  int add_force(const RigidForce& force);
  int add_spring(const RigidSpring& spring);
  int add_joint(const RigidJoint& joint);
  int add_pair(const RigidPair& pair);

  /// Overlap of this pair at the present poses is allowed from now on, sample by sample. Samples
  /// within `around_mm` of one that overlaps now are ignored.
  void allow_overlap(int pair, double around_mm = 0);

  void set_force(int force, const Eigen::Vector3d& force_N);
  void set_pose(int body, const Pose& X_WB);  // discontinuous; the motion is unchanged
  void set_motion(int body, const RigidMotion& motion);

  /// Advances by settings().step_s, in substeps where nearby bodies are fast. The state is
  /// unchanged, and `taken` false, when a speed would exceed its limit or a value would not be
  /// finite.
  struct Step {
    bool taken = true;
    int parts = 1;              // number of substeps
    int sweeps = 0;             // of the solver, in total
    double joint_error_mm = 0;  // largest before the step
    double depth_mm = 0;        // largest before the step, beyond the allowance
  };
  Step step(int threads = 1);

  const RigidSettings& settings() const;
  int body_count() const;
  const Pose& pose(int body) const;
  const RigidMotion& motion(int body) const;
  const MassProperties& mass(int body) const;
  RigidState state() const;
  void set_state(const RigidState& state);  // of a world with the same objects

  /// Contact forces of the last step.
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
