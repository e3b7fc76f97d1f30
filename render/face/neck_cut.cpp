#include "render/face/neck_cut.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace condyle {

using Eigen::Vector3f;

std::optional<float> find_neck_cut(std::span<const Vector3f> rest,
                                   std::span<const Eigen::Vector3i> triangles,
                                   std::span<const int> rim) {
  constexpr float below_mouth_mm = 110;                               // beyond the chin
  constexpr float uneven_mm = 40, downward = 0.8f, least_mm2 = 6000;  // of the flat surface
  float low = std::numeric_limits<float>::infinity(), mouth = low;
  for (const int v : rim) mouth = std::min(mouth, rest[static_cast<std::size_t>(v)].z());
  const auto corner = [&](const Eigen::Vector3i& t, int k) -> const Vector3f& {
    return rest[static_cast<std::size_t>(t[k])];
  };
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) low = std::min(low, corner(t, k).z());
  if (rim.empty() || mouth - low < below_mouth_mm) return std::nullopt;
  float area = 0;
  for (const auto& t : triangles) {
    const Vector3f n = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    const float highest = std::max({corner(t, 0).z(), corner(t, 1).z(), corner(t, 2).z()});
    if (highest < low + uneven_mm && -n.z() > downward * n.norm()) area += 0.5f * n.norm();
  }
  return area < least_mm2 ? std::nullopt : std::optional(low);
}

}  // namespace condyle
