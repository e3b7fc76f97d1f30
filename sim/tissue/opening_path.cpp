#include "sim/tissue/opening_path.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

namespace condyle {

using Eigen::Vector3d;

namespace {

/// 0 below zero, the identity above, rounded over some mm between.
double rounded_ramp(double mm) { return 0.5 * (mm + std::sqrt(mm * mm + 4)); }

}  // namespace

Pose OpeningPath::pose(double angle_rad) const {
  // A hinge to 12 degrees, then 1.5 degrees of rotation per mm of translation, to the limit of the
  // joint; initially 40 degrees down the eminence.
  const double linear = rounded_ramp((angle_rad / degree - 12) / 1.5) - rounded_ramp(-12 / 1.5);
  const double slide = linear - rounded_ramp(linear - 16.5);
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
  // Beyond the ends the path continues straight: the missing knot is 2 p0 - p1.
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

Nodes OpeningPredictor::extrapolated(const Nodes& from, const BodyWeights& weights,
                                     std::span<const Pose> X_CB_from,
                                     std::span<const Pose> X_CB_to) const {
  const bool has_path = path && !path->nodes.empty();
  const double before = path ? path->parameter(pose_in(X_CB_from, body)) : 0;
  const double after = path ? path->parameter(pose_in(X_CB_to, body)) : 0;
  // For each body, its motion beyond the path's.
  std::vector<Pose> beyond_before(std::max(X_CB_from.size(), X_CB_to.size()));
  std::vector<Pose> beyond_after(beyond_before.size());
  for (std::size_t b = 0; b < beyond_before.size(); ++b) {
    const BodyId of{static_cast<int>(b)};
    beyond_before[b] = pose_in(X_CB_from, of);
    beyond_after[b] = pose_in(X_CB_to, of);
    if (!path || std::find(along.begin(), along.end(), of) == along.end()) continue;
    beyond_before[b] = beyond_before[b] * path->pose(before).inverse();
    beyond_after[b] = beyond_after[b] * path->pose(after).inverse();
  }
  OpeningPath::Weights w_before, w_after;
  if (has_path) {
    w_before = path->weights(before);
    w_after = path->weights(after);
  }
  Nodes nodes = from;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Vector3d& x = from[i];
    for (const auto& [carrier, weight] : weights[i])
      if (const std::size_t b = index_of(carrier); b < beyond_before.size())
        nodes[i] += weight * (beyond_after[b] * x - beyond_before[b] * x);
    if (!has_path) continue;
    for (int k = 0; k < 4; ++k)
      nodes[i] += w_after.weight[k] * path->nodes[w_after.knot[k]][i] -
                  w_before.weight[k] * path->nodes[w_before.knot[k]][i];
  }
  return nodes;
}

}  // namespace condyle
