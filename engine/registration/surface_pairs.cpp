#include "engine/registration/surface_pairs.h"

#include <algorithm>

#include "engine/mesh/topology.h"

namespace condyle {

SurfacePairs::SurfacePairs(const TriMesh& surface)
    : tree_(surface), triangles_(surface.triangles), rim_vertex_(surface.vertices.size()) {
  for (const Edge& edge : find_edges(surface).edges)
    if (edge.count == 1) {
      rim_edges_.emplace_back(edge.low, edge.high);
      rim_vertex_[static_cast<std::size_t>(edge.low)] = true;
      rim_vertex_[static_cast<std::size_t>(edge.high)] = true;
    }
}

bool SurfacePairs::on_rim(const SurfacePoint& found) const {
  constexpr double at_edge = 1e-9;
  const Eigen::Vector3i& corners = triangles_[static_cast<std::size_t>(found.triangle)];
  for (int k = 0; k < 3; ++k) {
    if (found.barycentric[k] > at_edge) continue;
    const int a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
    if (std::binary_search(rim_edges_.begin(), rim_edges_.end(),
                           std::pair<int, int>(std::minmax(a, b))))
      return true;
  }
  for (int k = 0; k < 3; ++k)
    if (found.barycentric[k] >= 1 - at_edge)
      return rim_vertex_[static_cast<std::size_t>(corners[k])];
  return false;
}

std::optional<SurfacePair> SurfacePairs::find(const Eigen::Vector3d& p,
                                              const Eigen::Vector3d& normal,
                                              double least_cos) const {
  const SurfacePoint found = tree_.signed_nearest(p);
  if (found.triangle < 0 || on_rim(found)) return std::nullopt;
  SurfacePair pair{found.distance, found.point, tree_.pseudonormal(found)};
  if (pair.normal.dot(normal) < least_cos) return std::nullopt;
  return pair;
}

}  // namespace condyle
