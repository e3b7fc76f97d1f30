#pragma once

#include <algorithm>
#include <cmath>

namespace condyle {

/// Smaller of two distances with the crease rounded where they differ by less than k (mm).
/// Two equal distances come out k/4 smaller.
inline double smooth_min(double a, double b, double k) {
  if (k <= 0) return std::min(a, b);
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * (k * 0.25);
}

inline double smooth_max(double a, double b, double k) { return -smooth_min(-a, -b, k); }

/// Cubic step: 0 at t <= 0, 1 at t >= 1, flat at both ends.
inline double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace condyle
