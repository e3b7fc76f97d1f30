#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct RemeshSettings {
  /// Wanted edge length at a point, mm.
  std::function<double(const Eigen::Vector3d&)> edge_length;
  std::vector<int> pinned;  // vertices of the input that stay (corners of an outline)
  int rounds = 8;
};

struct Remeshed {
  TriMesh mesh;             // colours are not kept
  std::vector<int> pinned;  // where the pinned vertices are now
};

/// A coarse, well-shaped, manifold surface over `fine` with about the wanted edge lengths, whose
/// open borders run along those of `fine`: splits, collapses, flips, then smoothing along the
/// surface. `fine` must be manifold (open or closed) and oriented.
Remeshed remesh(const TriMesh& fine, const RemeshSettings& settings);

}  // namespace condyle
