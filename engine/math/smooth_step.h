#pragma once

#include <algorithm>

namespace condyle {

/// Cubic step: 0 at t <= 0, 1 at t >= 1, flat at both ends.
inline double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace condyle
