#pragma once

#include <span>

#include "engine/core/progress.h"
#include "engine/rigid/rigid_world.h"

namespace condyle {

struct RestSettings {
  double longest_s = 5;
  double still_mm_s = 0.01;  // no point of the body is faster
  double still_for_s = 0.1;
};

struct Rest {
  bool reached = false;  // it touches something and stayed still
  double seconds = 0;
  double depth_mm = 0;  // of the contacts at rest
};

/// Steps until bodies lie still on what they touch. Throwing from the progress gives up.
Rest run_to_rest(RigidWorld& world, std::span<const int> bodies, const RestSettings& settings = {},
                 int threads = 1, const Progress& progress = {});
Rest run_to_rest(RigidWorld& world, int body, const RestSettings& settings = {}, int threads = 1);

}  // namespace condyle
