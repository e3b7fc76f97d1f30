#pragma once

#include "sim/simulator/simulator.h"

namespace condyle::test {

/// The jaw is at rest except for hands.
inline Motion resting() {
  return {"rest", 1.0, false, [](double) { return Pose{}; }, {}};
}

}  // namespace condyle::test
