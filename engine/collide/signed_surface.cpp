#include "engine/collide/signed_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/collide/shells.h"
#include "engine/core/infinity.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

/// The closed shells, or the open ones, as one mesh.
TriMesh shells(const TriMesh& mesh, bool closed) {
  TriMesh kept;
  for (const Shell& shell : solid_shells(mesh)) {
    if (shell.closed != closed) continue;
    const int first = static_cast<int>(kept.vertices.size());
    kept.vertices.insert(kept.vertices.end(), shell.mesh.vertices.begin(),
                         shell.mesh.vertices.end());
    for (const auto& t : shell.mesh.triangles)
      kept.triangles.push_back(t + Eigen::Vector3i::Constant(first));
  }
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
