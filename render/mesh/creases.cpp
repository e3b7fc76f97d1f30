#include "render/mesh/creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace condyle {
namespace {

constexpr float reach_mm = 10, cell_mm = 5;
using Cell = std::array<int, 3>;

Cell cell_of(const Eigen::Vector3f& p) {
  Cell cell;
  for (int k = 0; k < 3; ++k)
    cell[static_cast<std::size_t>(k)] = static_cast<int>(std::floor(p[k] / cell_mm));
  return cell;
}

}  // namespace

std::vector<Crease> find_creases(std::span<const Eigen::Vector3f> positions,
                                 std::span<const Eigen::Vector3f> normals,
                                 std::span<const float> sky, float dark) {
  std::map<Cell, std::vector<int>> cells;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (sky[i] < dark) cells[cell_of(positions[i])].push_back(static_cast<int>(i));
  std::vector<Crease> creases;
  for (const auto& [cell, members] : cells)
    for (const int i : members) {
      Crease best{i, -1, reach_mm};
      for (int dz = -2; dz <= 2; ++dz)
        for (int dy = -2; dy <= 2; ++dy)
          for (int dx = -2; dx <= 2; ++dx) {
            const auto found = cells.find({cell[0] + dx, cell[1] + dy, cell[2] + dz});
            if (found == cells.end()) continue;
            for (const int j : found->second) {
              const Eigen::Vector3f edge = positions[j] - positions[i];
              const float length = edge.norm();
              // Across the fold: facing back, and nearly straight ahead.
              if (length < best.rest_mm && normals[i].dot(normals[j]) < -0.4f &&
                  normals[i].dot(edge) > 0.6f * length)
                best = {i, j, length};
            }
          }
      if (best.across >= 0) creases.push_back(best);
    }
  return creases;
}

float opened_sky(const Crease& crease, float sky, std::span<const Eigen::Vector3f> positions) {
  const float apart = (positions[crease.vertex] - positions[crease.across]).norm() - crease.rest_mm;
  const float s = std::clamp((apart - 1) / 7, 0.f, 1.f);
  return sky + (std::max(sky, 0.85f) - sky) * s * s * (3 - 2 * s);
}

}  // namespace condyle
