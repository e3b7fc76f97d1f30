#include "sim/motion/condylar_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace condyle {
namespace {

constexpr double step_mm = 0.5;
constexpr double deepest_drop_mm = 15;  // an eminence is 5 to 10 mm high

/// Zero before, one after, with a rounded corner of half-width w: integral of a ramp.
double rounded_ramp(double x, double w) {
  if (x <= -w) return 0;
  if (x >= w) return x;
  return (x + w) * (x + w) / (4 * w);
}

}  // namespace

double Coupling::forward_mm(double theta) const {
  constexpr double corner = 3 * radian_per_degree;  // the speed of the condyles does not jump
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
    (forward_mm(middle) < forward ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Pchip known_path(const CondylarPath& path) { return {path.forward_mm, path.drop_mm}; }

Pchip average_path() {
  constexpr double slope = 0.83909963117728;  // tan 40 deg
  constexpr std::array<double, 13> forward = {0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 20};
  std::array<double, 13> drop = {0, 0.7, 1.75, 2.9, 4, 5, 5.9, 7.3, 8.3, 8.9, 9.2, 9.3, 9.3};
  for (double& d : drop) d *= slope;
  return {forward, drop};
}

Pchip seated_path(JointSurfaces& joint, const Eigen::Vector3d& center, const Eigen::Vector3d& axis,
                  const Coupling& coupling) {
  constexpr double close_mm = 0.002, crossing_step_mm = 0.05;
  const auto slack = [&](double forward, double theta, double drop) {
    const Eigen::Quaterniond R(Eigen::AngleAxisd(theta, axis));
    return joint.slack_mm({R, center - R * center + Eigen::Vector3d(0, -forward, -drop)});
  };
  std::vector<double> forward = {0}, needed = {0};
  double drop = 0;
  for (int i = 1; i * step_mm < longest_forward_mm; ++i) {
    const double s = i * step_mm, theta = coupling.theta(s);
    // Gaps change by at most a millimetre per millimetre: moves by the slack pass through no wall.
    for (int k = 0; k < 200 && drop < deepest_drop_mm; ++k) {
      const double room = slack(s, theta, drop);
      if (std::abs(room) <= close_mm) break;
      if (room > 0 && drop <= 0) break;
      drop = room > 0 ? std::max(drop - room, 0.0) : drop + std::max(-room, crossing_step_mm * 0.1);
    }
    if (drop >= deepest_drop_mm) break;
    forward.push_back(s);
    needed.push_back(drop);
  }
  // The joint does not climb again, and the facets of the surface are rounded off: an average of
  // neighbours, lifted nowhere above what the gap needs.
  for (std::size_t i = 1; i < needed.size(); ++i) needed[i] = std::max(needed[i], needed[i - 1]);
  std::vector<double> smooth = needed;
  for (std::size_t i = 1; i + 1 < needed.size(); ++i)
    smooth[i] = std::max(needed[i], (needed[i - 1] + 2 * needed[i] + needed[i + 1]) / 4);
  if (forward.size() < 2) {
    forward.push_back(step_mm);
    smooth.push_back(0);
  }
  return {forward, smooth};
}

}  // namespace condyle
