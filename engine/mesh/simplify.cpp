#include "engine/mesh/simplify.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cassert>

#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

TriMesh collapsed(const TriMesh& mesh, const std::vector<float>& positions,
                  const std::vector<unsigned int>& indices, int target) {
  std::vector<unsigned int> kept(indices.size());
  kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), positions.data(),
                               mesh.vertices.size(), 3 * sizeof(float),
                               3 * static_cast<std::size_t>(target), 1.0f, 0, nullptr));
  TriMesh result{mesh.vertices, {}, mesh.colors};
  result.triangles.reserve(kept.size() / 3);
  for (std::size_t i = 0; i + 2 < kept.size(); i += 3)
    result.triangles.emplace_back(static_cast<int>(kept[i]), static_cast<int>(kept[i + 1]),
                                  static_cast<int>(kept[i + 2]));
  drop_flaps(result.triangles);
  drop_unreferenced(result);
  return result;
}

}  // namespace

void drop_flaps(std::vector<Eigen::Vector3i>& triangles) {
  std::vector<std::array<int, 4>> keys(triangles.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    std::copy_n(triangles[i].data(), 3, keys[i].begin());
    std::sort(keys[i].begin(), keys[i].begin() + 3);
    keys[i][3] = static_cast<int>(i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<char> gone(keys.size(), 0);
  for (std::size_t i = 0; i + 1 < keys.size(); ++i)
    if (std::equal(keys[i].begin(), keys[i].begin() + 3, keys[i + 1].begin())) {
      gone[static_cast<std::size_t>(keys[i][3])] = gone[static_cast<std::size_t>(keys[i + 1][3])] =
          1;
      ++i;
    }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < gone.size(); ++i)
    if (!gone[i]) triangles[kept++] = triangles[i];
  triangles.resize(kept);
}

TriMesh simplify(const TriMesh& mesh, int target_triangles) {
  const int count = static_cast<int>(mesh.triangles.size());
  if (count <= target_triangles || count < 4) return mesh;
  int target = std::max(target_triangles, 4);

  // Relative to the centre: floats far from the origin would lose detail.
  const Eigen::Vector3d middle = bounding_box(mesh).center();
  std::vector<float> positions;
  positions.reserve(3 * mesh.vertices.size());
  for (const auto& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(v[k] - middle[k]));
  std::vector<unsigned int> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) indices.push_back(static_cast<unsigned int>(t[k]));

  const bool closed = inspect(mesh).closed();
  while (target < count) {
    TriMesh result = collapsed(mesh, positions, indices, target);
    if (!closed || inspect(result).closed()) return result;
    target += std::max(target / 4, 4);
  }
  return mesh;
}

std::vector<Eigen::Vector3i> coarser(std::span<const Eigen::Vector3f> positions,
                                     std::span<const Eigen::Vector3i> triangles,
                                     int target_triangles, double error_mm, Rims rims) {
  assert(error_mm >= 0);
  std::vector<Eigen::Vector3i> result(triangles.begin(), triangles.end());
  if (static_cast<int>(triangles.size()) <= target_triangles) return result;
  std::vector<unsigned int> indices, kept(3 * triangles.size());
  indices.reserve(kept.size());
  for (const auto& t : triangles)
    for (const int v : t) indices.push_back(static_cast<unsigned int>(v));
  const float* at = positions[0].data();
  constexpr std::size_t stride = sizeof(Eigen::Vector3f);
  const float extent = meshopt_simplifyScale(at, positions.size(), stride);
  kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), at, positions.size(),
                               stride, 3 * static_cast<std::size_t>(std::max(target_triangles, 1)),
                               static_cast<float>(error_mm) / std::max(extent, 1e-6f),
                               rims == Rims::fixed ? unsigned{meshopt_SimplifyLockBorder} : 0u,
                               nullptr));
  result.clear();
  for (std::size_t i = 0; i + 2 < kept.size(); i += 3)
    result.emplace_back(static_cast<int>(kept[i]), static_cast<int>(kept[i + 1]),
                        static_cast<int>(kept[i + 2]));
  return result;
}

}  // namespace condyle
