#include "render/face/tongue_relief.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/math/smooth_step.h"

namespace condyle {

using Eigen::Vector3f;

std::vector<Vector3f> unrolled_tongue(std::span<const Vector3f> rest) {
  Eigen::AlignedBox3f box;
  for (const auto& p : rest) box.extend(p);
  std::vector<Vector3f> unrolled;
  unrolled.reserve(rest.size());
  for (const auto& p : rest) {
    const float back = (p.y() - box.min().y()) / std::max(box.sizes().y(), 1e-3f);
    const float side = 2 * static_cast<float>(smooth_step((back - 0.2) / 0.6)) - 1;
    unrolled.emplace_back(p.x() - box.center().x(), p.y() + side * (box.max().z() - p.z()), 0);
  }
  return unrolled;
}

std::vector<Vector3f> unrolled_tongue(const MouthLining& lining) {
  float middle = 0, weights = 0;
  for (std::size_t v = 0; v < lining.rest.size(); ++v) {
    middle += lining.tongue[v] * lining.rest[v].x();
    weights += lining.tongue[v];
  }
  if (weights > 0) middle /= weights;
  std::vector<Vector3f> places;
  places.reserve(lining.rest.size());
  for (const auto& p : lining.rest) places.emplace_back(p.x() - middle, p.y(), 0);
  return places;
}

float smoothness_of_tongue(const Vector3f& normal) {
  const double aside = smooth_step((std::abs(normal.x()) - 0.5) / 0.35);
  const double below = smooth_step((-0.2 - normal.z()) / 0.5);
  return static_cast<float>(1 - (1 - aside) * (1 - below));
}

}  // namespace condyle
