#pragma once

#include <Eigen/Core>

#include "engine/rigid/rigid_world.h"
#include "sim/case/case.h"
#include "sim/dynamics/rest.h"

namespace condyle {

struct JawWorldSettings {
  Pose X_CM = {};                             // where the mandible starts
  Eigen::Vector3d bite_force_N = {0, 0, 60};  // cranium's directions
  // Where it acts: its share of the way from between the condyles to the lower incisal point.
  double bite_place = 0.5;
  double friction = 0.1;      // of wet teeth
  double lost_in_step = 0.3;  // share of its speed that soft tissue takes in a step, below 2
};

/// The mandible as a free body: lower on upper teeth, its condyles led on their paths.
struct JawWorld {
  RigidWorld world;
  int mandible = 0;
  int bite_force = 0;
};

/// Condyles follow the case's own path, else an average one; they may move sideways together, as
/// far as the teeth let them. throws: InputError when teeth, condyles or the mandible are missing.
JawWorld make_jaw_world(const Case& patient, const JawWorldSettings& settings = {},
                        int threads = 1);

}  // namespace condyle
