#include "sim/tissue/pose_steps.h"

#include <algorithm>
#include <cmath>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

/// Contact finds points within 2 mm of a surface by its field, to a depth of 12 mm.
constexpr double step_mm = 2;
constexpr int max_steps = 16;

/// The body that an obstacle's motion is measured against: the lower arch for bodies that open with
/// it.
BodyId reference_of(const OpeningPredictor& opening, BodyId body) {
  const bool opens =
      std::find(opening.along.begin(), opening.along.end(), body) != opening.along.end();
  return opens ? opening.body : cranium_body;
}

/// Largest displacement of a corner of the box between two poses, mm.
double displacement(const Box& box, const Pose& from, const Pose& to) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p(corner & 1 ? box.high.x() : box.low.x(),
                            corner & 2 ? box.high.y() : box.low.y(),
                            corner & 4 ? box.high.z() : box.low.z());
    most = std::max(most, (to * p - from * p).norm());
  }
  return most;
}

}  // namespace

std::vector<std::vector<Pose>> pose_steps(const TissueModel& model, std::span<const Pose> X_CB_from,
                                          std::span<const Pose> X_CB_to) {
  const OpeningPredictor& opening = model.opening;
  const auto& obstacles = model.contact->obstacles;
  const auto against = [&](std::span<const Pose> X_CB, BodyId body) {
    return pose_in(X_CB, reference_of(opening, body)).inverse() * pose_in(X_CB, body);
  };
  double most = 0;
  for (const auto& obstacle : obstacles)
    if (obstacle.body != reference_of(opening, obstacle.body))
      most = std::max(most, displacement(obstacle.extent, against(X_CB_from, obstacle.body),
                                         against(X_CB_to, obstacle.body)));
  const int count = std::clamp(static_cast<int>(std::ceil(most / step_mm)), 1, max_steps);
  std::vector<std::vector<Pose>> steps;
  for (int i = 1; i < count; ++i) {
    const double s = static_cast<double>(i) / count;
    std::vector<Pose> X_CB(X_CB_to.begin(), X_CB_to.end());
    const Eigen::Vector3d pivot =
        opening.path ? opening.path->condyles : Eigen::Vector3d(Eigen::Vector3d::Zero());
    const auto between = [&](BodyId body) {
      return interpolate(pose_in(X_CB_from, body), pose_in(X_CB_to, body), s, pivot);
    };
    for (std::size_t b = 0; b < X_CB.size(); ++b) X_CB[b] = between(BodyId{static_cast<int>(b)});
    for (const auto& obstacle : obstacles) {
      const BodyId body = obstacle.body, reference = reference_of(opening, body);
      if (body == reference || index_of(body) >= X_CB.size()) continue;
      X_CB[index_of(body)] =
          between(reference) * interpolate(against(X_CB_from, body), against(X_CB_to, body), s,
                                           obstacle.extent.center());
    }
    steps.push_back(std::move(X_CB));
  }
  steps.emplace_back(X_CB_to.begin(), X_CB_to.end());
  return steps;
}

}  // namespace condyle
