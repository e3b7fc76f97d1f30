#pragma once

#include <algorithm>
#include <cmath>

#include "engine/math/smooth_step.h"

namespace condyle {

/// Smaller of two distances, with the crease rounded where they differ by less than k (mm).
/// Two equal distances give a result that is k/4 smaller.
inline double smooth_min(double a, double b, double k) {
  if (k <= 0) return std::min(a, b);
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * (k * 0.25);
}

inline double smooth_max(double a, double b, double k) { return -smooth_min(-a, -b, k); }

}  // namespace condyle
