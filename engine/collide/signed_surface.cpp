#include "engine/collide/signed_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/parallel.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Triangles of the closed (or of the open) shells.
TriMesh shells(const TriMesh& mesh, bool closed) {
  const Components components = find_components(mesh);
  std::vector<bool> balanced(static_cast<std::size_t>(components.count), true);
  const EdgeList list = find_edges(mesh);
  for (const Edge& edge : list.edges) {
    int balance = 0;
    for (int i = 0; i < edge.count; ++i) balance += list.sides[edge.first + i].forward ? 1 : -1;
    if (balance != 0) balanced[components.of_triangle[list.sides[edge.first].triangle]] = false;
  }
  TriMesh kept{mesh.vertices, {}, {}};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (balanced[components.of_triangle[i]] == closed) kept.triangles.push_back(mesh.triangles[i]);
  return kept;
}

}  // namespace

TriMesh closed_shells(const TriMesh& mesh) { return shells(mesh, true); }

SignedSurface::SignedSurface(const TriMesh& mesh) : solid_(mesh) {
  for (const auto& t : mesh.triangles)
    for (const int v : t) box_.add(mesh.vertices[v]);
  if (solid_.open_shell_count() > 0) open_ = std::make_unique<TriangleTree>(shells(mesh, false));
}

double SignedSurface::distance(const Eigen::Vector3d& p) const {
  const double to_closed = has_inside() ? solid_.signed_distance(p) : infinity;
  if (!open_ || to_closed <= 0) return to_closed;
  return std::min(to_closed, open_->nearest(p, to_closed).distance);
}

std::vector<float> distances_to(const SignedSurface& surface, const Pose& X_WS,
                                std::span<const Eigen::Vector3d> points, double reach_mm,
                                int threads) {
  constexpr std::size_t run = 1024;
  const Pose X_SW = X_WS.inverse();
  std::vector<float> found(points.size(), std::numeric_limits<float>::infinity());
  parallel_for((points.size() + run - 1) / run, threads, [&](std::size_t r) {
    for (std::size_t i = r * run; i < std::min(points.size(), (r + 1) * run); ++i) {
      const Eigen::Vector3d p = X_SW * points[i];
      if (surface.box().contains(p, reach_mm)) found[i] = static_cast<float>(surface.distance(p));
    }
  });
  return found;
}

}  // namespace condyle
