#include "engine/collide/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/hash.h"

namespace condyle {

using Eigen::Vector3d;

double DistanceField::lower_bound(const Vector3d& p) const {
  const double edge = cells * settings_.spacing_mm;
  Vector3d center;
  int place[3];
  double outside2 = 0;
  for (int k = 0; k < 3; ++k) {
    const double u = (p[k] - origin_[k]) / edge;
    const double over = std::max({0.0, -u, u - size_[k]});
    outside2 += over * over;
    place[k] = static_cast<int>(std::clamp(u, 0.0, size_[k] - 1.0));
    center[k] = origin_[k] + (place[k] + 0.5) * edge;
  }
  const double near = bound_[slot(place[0], place[1], place[2])] - (p - center).norm();
  return outside2 > 0 ? std::max(near, std::sqrt(outside2) * edge) : near;
}

void DistanceField::lay_out(const TriMesh& mesh) {
  per_mm_ = 1 / settings_.spacing_mm;
  Box box = bounding_box(mesh);
  const double margin = settings_.band_mm + settings_.spacing_mm;
  box.low.array() -= margin;
  box.high.array() += margin;
  if (settings_.region) {
    box.low = box.low.cwiseMax(settings_.region->low);
    box.high = box.high.cwiseMin(settings_.region->high);
    if (box.empty()) box.high = box.low;  // no part of the surface lies in the region
  }
  origin_ = box.low;
  for (int k = 0; k < 3; ++k)
    size_[k] =
        std::max(1, static_cast<int>(std::ceil((box.high[k] - box.low[k]) * per_mm_ / cells)));
  const std::size_t places = slot(0, 0, size_[2]);
  brick_.assign(places, -1);
  bound_.assign(places, std::numeric_limits<float>::infinity());
}

/// A distance changes by at most the displacement: where it changes by more, its sign is
/// discontinuous.
void DistanceField::mark_unknown(Brick& brick, double spacing_mm) {
  const float most = static_cast<float>(spacing_mm * 1.0001 + 1e-5);
  const int step[3] = {1, corners, corners * corners};
  for (int z = 0; z < corners; ++z)
    for (int y = 0; y < corners; ++y)
      for (int x = 0; x < corners; ++x) {
        const int at[3] = {x, y, z};
        const int here = x + corners * (y + corners * z);
        for (int axis = 0; axis < 3; ++axis) {
          if (at[axis] == cells) continue;
          if (std::abs(brick.value[here + step[axis]] - brick.value[here]) <= most) continue;
          // The four cells at this edge.
          const int p = (axis + 1) % 3, q = (axis + 2) % 3;
          for (int i = -1; i <= 0; ++i)
            for (int j = -1; j <= 0; ++j) {
              int cell[3] = {x, y, z};
              cell[p] += i;
              cell[q] += j;
              if (cell[p] >= 0 && cell[p] < cells && cell[q] >= 0 && cell[q] < cells)
                brick.unknown.set(
                    static_cast<std::size_t>(cell[0] + cells * (cell[1] + cells * cell[2])));
            }
        }
      }
}

std::size_t DistanceField::memory_bytes() const {
  return bricks_.size() * sizeof(Brick) + brick_.size() * sizeof(brick_[0]) +
         bound_.size() * sizeof(bound_[0]);
}

std::uint64_t DistanceField::grid_hash() const {
  return hash_values(std::span<const int>(size_),
                     hash_values(std::span<const double>(origin_.data(), 3)));
}

std::uint64_t DistanceField::hash() const {
  std::uint64_t h = hash_values(std::span<const int>(size_));
  h = hash_values(std::span<const std::int32_t>(brick_), h);
  h = hash_values(std::span<const float>(bound_), h);
  for (const Brick& brick : bricks_) h = hash_values(std::span<const float>(brick.value), h);
  return h;
}

}  // namespace condyle
