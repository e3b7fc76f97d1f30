#pragma once

#include <algorithm>

#include "sim/simulator/simulator.h"

namespace condyle::test {

/// The jaw stays where it is but for hands.
inline Motion resting() {
  return {"rest", 1.0, false, [](double) { return Pose{}; }, {}};
}

inline std::size_t mandible_of(const Scene& scene) {
  const auto& parts = scene.patient.parts;
  return static_cast<std::size_t>(
      std::find_if(parts.begin(), parts.end(),
                   [](const Part& part) { return part.role == Role::mandible; }) -
      parts.begin());
}

}  // namespace condyle::test
