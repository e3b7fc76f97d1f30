#pragma once

#include <span>

#include "engine/core/progress.h"
#include "engine/rigid/rigid_world.h"

namespace condyle {

struct RestSettings {
  double longest_s = 5;
  double still_mm_s = 0.01;  // speed limit of every point of the body
  double still_for_s = 0.1;
};

struct Rest {
  bool reached = false;  // it touches something and was at rest for long enough
  double seconds = 0;
  double depth_mm = 0;  // of the contacts at rest
};

/// Steps until bodies are at rest in contact. An exception from `progress` cancels.
Rest run_to_rest(RigidWorld& world, std::span<const int> bodies, const RestSettings& settings = {},
                 int threads = 1, const Progress& progress = {});
Rest run_to_rest(RigidWorld& world, int body, const RestSettings& settings = {}, int threads = 1);

}  // namespace condyle
