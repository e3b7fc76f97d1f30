#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "engine/math/pchip.h"
#include "engine/rigid/rigid_world.h"
#include "sim/case/case.h"
#include "sim/dynamics/rest.h"
#include "sim/frame/body_poses.h"

namespace condyle {

struct JawWorldSettings {
  Pose X_CM = {};                             // initial pose of the mandible
  Eigen::Vector3d bite_force_N = {0, 0, 60};  // in the cranium's directions
  // Where the force acts: fraction of the distance from between the condyles to the lower incisal
  // point.
  double bite_position = 0.5;
  double friction = 0.1;      // of wet teeth
  double lost_in_step = 0.3;  // fraction of its speed that soft tissue removes in a step, below 2
  // Replaces that fraction where known: drag force and torque per velocity and angular velocity.
  std::optional<double> drag_kg_s = {}, turning_drag_kg_mm2_s = {};
  // point of the mandible where drag acts; default: its centre of mass
  std::optional<Eigen::Vector3d> drag_at = {};
  bool teeth = true;  // false: upper and lower teeth do not collide
  // Crowns that overlap at rest are treated as worn by that amount: this overlap is allowed
  // everywhere.
  bool worn_crowns = false;
  bool stops = false;  // condyles move neither behind their seats nor apart sideways
  bool fossa = false;  // condyles keep the disc gap to the fossa, where there is one
  // The mandible also collides with the rest of the skull, except where they overlap at rest. Other
  // bodies have these poses and move with the cranium or the jaw.
  std::optional<BodyPoses> bones = {};
};

/// The mandible as a free body: lower on upper teeth, its condyles guided on their paths.
struct JawWorld {
  RigidWorld world;
  int mandible = 0;
  int bite_force = 0;
  std::optional<int> bite = {}, bones = {};  // pairs of the world
  double worn_mm = 0;                        // assumed wear of the crowns
  std::array<Eigen::Vector3d, 2> condyles;   // left, right, seated
  std::array<Pchip, 2> inferior_mm;          // of each condyle, by its forward travel
  std::string guide;                         // description of the source of the paths
};

/// Condyles follow the guide of the case's mechanics; else their fossa, if requested; else the
/// case's own path, else an average one. They may move sideways together as far as the teeth
/// permit. The crowns are the teeth, or those of the bone that carries them (see find_arches). The
/// mass is the case's own, else that of its surface. An exception from `progress` cancels. throws:
/// InputError when crowns, condyles or the mandible are missing.
JawWorld make_jaw_world(const Case& patient, const JawWorldSettings& settings = {}, int threads = 1,
                        const Progress& progress = {});

}  // namespace condyle
