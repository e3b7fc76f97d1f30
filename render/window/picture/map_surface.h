#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A part's surface in smaller triangles, for colours by values. normals: unit, one per vertex.
struct MapSurface {
  std::size_t part = 0;  // in the scene
  const TriMesh* mesh = nullptr;
  std::span<const Eigen::Vector3f> normals = {};
};

/// One value per vertex of each map surface, in their order.
using MapValues = std::vector<std::vector<float>>;

}  // namespace condyle
