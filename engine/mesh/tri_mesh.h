#pragma once

#include <Eigen/Core>
#include <vector>

namespace condyle {

/// Triangle surface, mm. Triangles run counter-clockwise seen from outside.
struct TriMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;  // indices into vertices
  std::vector<Eigen::Vector3f> colors;     // one sRGB colour per vertex, 0 to 1, or empty

  bool empty() const { return triangles.empty(); }
};

}  // namespace condyle
