#pragma once

#include <fcl/geometry/bvh/BVH_model.h>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

// For sources of this module alone.

// The packaged library was built with an alignment of 16; wider vector flags would be incompatible.
static_assert(alignof(fcl::Transform3d) == 16);

inline fcl::Transform3d fcl_transform(const Pose& X) {
  fcl::Transform3d T = fcl::Transform3d::Identity();
  T.linear() = X.R.toRotationMatrix();
  T.translation() = X.t;
  return T;
}

/// Builds the tree of boxes of an empty model.
template <class Bounds>
void build_model(const TriMesh& mesh, fcl::BVHModel<Bounds>& model) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                           static_cast<std::size_t>(t[2]));
  model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  model.addSubModel(mesh.vertices, triangles);
  model.endModel();
}

}  // namespace condyle
