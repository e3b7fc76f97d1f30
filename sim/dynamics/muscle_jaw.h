#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sim/case/case.h"
#include "sim/dynamics/bite_plane.h"
#include "sim/dynamics/bolus.h"
#include "sim/dynamics/hyoid.h"
#include "sim/dynamics/jaw_world.h"
#include "sim/frame/muscle_state.h"
#include "sim/muscles/muscle_law.h"

namespace condyle {

/// A force with a torque about the centre of mass, or a velocity with an angular velocity.
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct MuscleJawSettings {
  Pose X_CM = {};  // initial pose of the mandible
  MuscleLawSettings law = {};
  BolusSettings bolus = {};
  enum class HyoidMode { free, fixed, prescribed } hyoid = HyoidMode::free;
  std::function<Eigen::Vector3d(double time_s)> hyoid_displacement =
      {};                 // from rest, where prescribed
  bool teeth = true;      // false: a flat bite through the back teeth at rest
  double friction = 0.1;  // of wet teeth
  std::optional<Eigen::Vector3d> damped_at =
      {};  // point of the mandible where drag acts; default: the origin of its frame
  std::optional<BodyPoses> bones = {};  // as of a JawWorld
  bool fossa = true;  // condyles on the fossa, where there is one and no measured guide
  std::vector<std::string> without = {};  // names of muscles that are removed
};

/// The mandible as a rigid body driven by muscles, with condylar guides, posterior and lateral
/// stops, gravity, tooth contact and optionally a bolus.
class MuscleJaw {
 public:
  /// An exception from `progress` cancels.
  /// throws: InputError when landmarks, teeth or muscles of the patient are unsuitable.
  MuscleJaw(const Case& patient, const MuscleJawSettings& settings, int threads = 1,
            const Progress& progress = {});

  /// One step with an excitation from 0 to 1 for each muscle. False, without change of state, when
  /// a velocity would exceed that of a jaw.
  bool step(std::span<const double> excitations, int threads = 1);

  const std::vector<Muscle>& muscles() const { return muscles_; }
  double step_s() const { return jaw_.world.settings().step_s; }
  double time_s() const { return time_s_; }
  const Pose& pose() const { return jaw_.world.pose(jaw_.mandible); }
  const RigidMotion& motion() const { return jaw_.world.motion(jaw_.mandible); }
  const Pose& hyoid_pose() const { return hyoid_.pose(); }
  const MuscleStates& states() const { return states_; }
  /// Wear assumed on crowns that overlap at rest, mm.
  double worn_mm() const { return jaw_.worn_mm; }
  /// Description of the condylar guide.
  const std::string& guide() const { return jaw_.guide; }
  double bolus_push_N() const { return bolus_push_N_; }
  const JawWorld& jaw() const { return jaw_; }
  const RigidWorld& world() const { return jaw_.world; }

  /// Wrench of a muscle on the mandible in the present state, at full activation and at none, about
  /// the centre of mass (zero for a muscle that does not attach there).
  struct Pull {
    Vector6d direction;  // unit force and its torque, N and N mm
    MuscleTension tension;
  };
  std::vector<Pull> pulls() const;
  /// Force and torque of gravity, drag and bolus on the mandible, N and N mm.
  Vector6d other_forces() const;
  /// Constraints of the guides and lateral stops: row . (velocity, angular velocity) = 0.
  Eigen::Matrix<double, 3, 6> held() const;
  Eigen::Vector3d center() const { return pose() * mass_.center; }
  const MassProperties& mass() const { return mass_; }
  const MuscleLawSettings& law() const { return settings_.law; }

 private:
  struct Line;
  Line line(const Muscle& muscle) const;
  Vector6d direction(std::size_t muscle, const Line& now) const;
  Eigen::MatrixXd free_directions() const;
  void pull(std::span<const double> excitations);
  void move_hyoid();

  std::vector<Muscle> muscles_;
  MuscleJawSettings settings_;
  JawWorldSettings world_settings_;
  JawWorld jaw_;
  MassProperties mass_;
  Hyoid hyoid_;
  BitePlane bite_;
  std::optional<Bolus> bolus_;
  std::vector<int>
      forces_;  // force index in the world for each muscle; -1: not attached to the mandible
  int bolus_force_ = -1;
  MuscleStates states_;
  double time_s_ = 0, bolus_push_N_ = 0;
};

}  // namespace condyle
