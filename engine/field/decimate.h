#pragma once

#include <Eigen/Core>
#include <functional>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct DecimationOptions {
  int target_triangles = 50000;
  /// Refinement of the surface at a point, relative to elsewhere: edges shrink with the fourth
  /// root.
  std::function<double(const Eigen::Vector3d&)> importance = {};  // empty = 1 everywhere
  double evenness = 1e-3;  // weight of edge length against shape error; larger: rounder triangles
};

/// Collapses edges by quadric error (Garland and Heckbert 1997) until few enough triangles remain.
/// Never changes the topology, never turns a triangle over; open borders keep their shape, and
/// border vertices in the plane x = 0 stay in it and are never joined through the inside, so a half
/// can be mirrored afterwards. The mesh must be manifold. Colours are dropped.
TriMesh decimated(const TriMesh& mesh, const DecimationOptions& options);

}  // namespace condyle
