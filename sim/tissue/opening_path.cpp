#include "sim/tissue/opening_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace condyle {

using Eigen::Vector3d;

namespace {

/// 0 below zero, the identity above, rounded over some mm between.
double rounded_ramp(double mm) { return 0.5 * (mm + std::sqrt(mm * mm + 4)); }

}  // namespace

Pose OpeningPath::pose(double angle_rad) const {
  // A hinge to 12 degrees, then 1.5 degrees of turning for each mm of sliding, to the end of the
  // joint; 40 degrees down the eminence at first.
  constexpr double degree = std::numbers::pi / 180;
  const double wanted = rounded_ramp((angle_rad / degree - 12) / 1.5) - rounded_ramp(-12 / 1.5);
  const double slide = wanted - rounded_ramp(wanted - 16.5);
  Pose X_CM;
  X_CM.R = Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Vector3d::UnitX()));
  X_CM.t = condyles - X_CM.R * condyles + Vector3d(0, -slide, -7.5 * (1 - std::exp(-slide / 6)));
  return X_CM;
}

double OpeningPath::parameter(const Pose& X_CM) const {
  if (nodes.size() < 2) return 0;
  const double about_x = 2 * std::atan2(X_CM.R.x(), X_CM.R.w());
  return std::clamp(about_x, 0.0, step_rad * static_cast<double>(nodes.size() - 1));
}

OpeningPath::Weights OpeningPath::weights(double angle_rad) const {
  Weights w;
  const int last = static_cast<int>(nodes.size()) - 1;
  if (last < 1) return w;
  const double at = std::clamp(angle_rad / step_rad, 0.0, static_cast<double>(last));
  const int i = std::min(static_cast<int>(at), last - 1);
  const double t = at - i;
  w.knot = {std::max(i - 1, 0), i, i + 1, std::min(i + 2, last)};
  w.weight = {0.5 * t * (-1 + t * (2 - t)), 0.5 * (2 + t * t * (-5 + 3 * t)),
              0.5 * t * (1 + t * (4 - 3 * t)), 0.5 * t * t * (t - 1)};
  // Beyond the ends the path goes on straight: the missing knot is 2 p0 - p1.
  if (i == 0) {
    w.weight[1] += 2 * w.weight[0];
    w.weight[2] -= w.weight[0];
    w.weight[0] = 0;
  }
  if (i + 1 == last) {
    w.weight[2] += 2 * w.weight[3];
    w.weight[1] -= w.weight[3];
    w.weight[3] = 0;
  }
  return w;
}

}  // namespace condyle
