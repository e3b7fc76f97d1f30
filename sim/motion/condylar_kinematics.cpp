#include "sim/motion/condylar_kinematics.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace condyle {
namespace {

/// max(x, 0) with a corner rounded over |x| < w.
double rounded_ramp(double x, double w) {
  if (x <= -w) return 0;
  if (x >= w) return x;
  return (x + w) * (x + w) / (4 * w);
}

}  // namespace

double Coupling::forward_mm(double turned) const {
  const double theta = std::max(turned - closed, 0.0);
  constexpr double corner = 3 * degree;  // keeps the speed of the condyles continuous
  constexpr double full_travel_mm = 15;
  const double hinge_first = rounded_ramp(theta - hinge, corner) / rad_per_mm;
  const double from_start = theta * full_travel_mm / (hinge + full_travel_mm * rad_per_mm);
  const double forward = (1 - early) * hinge_first + early * from_start;
  constexpr double ending = 2;
  return forward - rounded_ramp(forward - longest_forward_mm, ending);
}

double Coupling::theta(double forward) const {
  if (forward <= 0) return 0;
  double low = 0, high = 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (forward_mm(closed + middle) < forward ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Pchip path_of_case(const CondylarPath& path) { return {path.forward_mm, path.inferior_mm}; }

Pchip average_path() { return inclined_path(40, 1); }

Pchip inclined_path(double inclination_deg, double shape) {
  const double slope = std::tan(inclination_deg * degree);
  constexpr std::array<double, 13> forward = {0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 20};
  constexpr std::array<double, 13> curved = {0,   0.7, 1.75, 2.9, 4,   5,  5.9,
                                             7.3, 8.3, 8.9,  9.2, 9.3, 9.3};
  constexpr std::array<double, 13> straight = {0, 1, 2, 3, 4, 5, 6, 8, 9.6, 10.6, 11, 11, 11};
  std::array<double, 13> drop{};
  for (std::size_t i = 0; i < drop.size(); ++i)
    drop[i] = slope * (shape * curved[i] + (1 - shape) * straight[i]);
  return {forward, drop};
}

}  // namespace condyle
