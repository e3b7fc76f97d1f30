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
  Pose X_CM = {};                             // where the mandible starts
  Eigen::Vector3d bite_force_N = {0, 0, 60};  // cranium's directions
  // Where it acts: its share of the way from between the condyles to the lower incisal point.
  double bite_place = 0.5;
  double friction = 0.1;      // of wet teeth
  double lost_in_step = 0.3;  // share of its speed that soft tissue takes in a step, below 2
  // In place of that share, where it is known: force and torque against velocity and spin.
  std::optional<double> drag_kg_s = {}, turning_drag_kg_mm2_s = {};
  std::optional<Eigen::Vector3d> drag_at = {};  // of the mandible; else its centre of mass
  bool teeth = true;                            // false: nothing keeps upper and lower teeth apart
  // Crowns that overlap at rest are taken as worn by as much: they may overlap so far everywhere.
  bool worn_crowns = false;
  bool stops = false;  // condyles go neither behind their seats nor apart sideways
  bool fossa = false;  // condyles keep their disc's gap to the fossa, where there is one
  // The mandible meets the rest of the skull, too, away from where they overlap at rest. Free parts
  // are where they are here, and go along with what carries them.
  std::optional<BodyPoses> bones = {};
};

/// The mandible as a free body: lower on upper teeth, its condyles led on their paths.
struct JawWorld {
  RigidWorld world;
  int mandible = 0;
  int bite_force = 0;
  std::optional<int> bite = {}, bones = {};  // pairs of the world
  double worn_mm = 0;                        // off the crowns
  std::array<Eigen::Vector3d, 2> condyles;   // left, right, seated
  std::array<Pchip, 2> drop_mm;              // of each condyle by its forward travel
  std::string guide;                         // where these come from, for people
};

/// Condyles follow the guide of the case's mechanics; else their fossa, where that is asked for;
/// else the case's own path, else an average one. They may move sideways together, as far as the
/// teeth let them. The mass is the case's own, else that of its surface. throws: InputError when
/// teeth, condyles or the mandible are missing. Throwing from the progress gives up.
JawWorld make_jaw_world(const Case& patient, const JawWorldSettings& settings = {}, int threads = 1,
                        const Progress& progress = {});

}  // namespace condyle
