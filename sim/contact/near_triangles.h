#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/collide/signed_surface.h"
#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The triangles of a surface in a tree of balls, for quick selection of those that can be near
/// another surface, or inside it. Queries are const and thread-safe.
class NearTriangles {
 public:
  /// At least one triangle.
  explicit NearTriangles(const TriMesh& mesh);

  /// The triangles in balls within `reach_mm` of the other surface or inside it, each with separate
  /// corners, in the order of the tree; body coordinates.
  TriMesh near(const Pose& X_W, const SignedSurface& other, const Pose& X_WO,
               double reach_mm) const;

 private:
  struct Ball {
    Eigen::Vector3d center;
    double radius = 0;
    int first = 0, count = 0;  // range of triangles
    int right = 0;             // second child (the first is next); 0 for a leaf
  };
  int build(const TriMesh& mesh, const std::vector<Eigen::Vector3d>& middles,
            std::vector<int>& order, int first, int last);

  TriMesh soup_;             // three separate corners for each triangle, in the order of the balls
  std::vector<Ball> balls_;  // depth first
};

}  // namespace condyle
