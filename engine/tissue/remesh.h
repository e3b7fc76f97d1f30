#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct RemeshSettings {
  /// Target edge length at a point, mm.
  std::function<double(const Eigen::Vector3d&)> edge_length;
  std::vector<int> pinned;  // vertices of the input that are kept (corners of an outline)
  int rounds = 8;
};

struct Remeshed {
  TriMesh mesh;             // colours are not kept
  std::vector<int> pinned;  // new indices of the pinned vertices
};

/// A coarse, well-shaped, manifold surface that approximates `fine` with about the target edge
/// lengths and open borders along those of `fine`: splits, collapses, flips, then smoothing along
/// the surface. `fine` must be manifold (open or closed) and oriented.
Remeshed remesh(const TriMesh& fine, const RemeshSettings& settings);

}  // namespace condyle
