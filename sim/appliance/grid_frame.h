#pragma once

#include <Eigen/Core>

#include "engine/core/parallel.h"
#include "engine/field/sampled_field.h"
#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A grid is moved by this, so that none of its samples lie in planes of symmetry, where corners of
/// meshes lie.
constexpr double grid_shift_mm = 0.0137;

/// Rows: an orthonormal frame with this z axis, unit.
Eigen::Matrix3d axes_along(const Eigen::Vector3d& z);

/// A mesh in the axes of a grid, without colours.
TriMesh in_axes(TriMesh mesh, const Eigen::Matrix3d& R, const Pose& X = {});

/// Appends the triangles of a mesh, which may overlap the others.
void append(TriMesh& mesh, const TriMesh& more);

/// body(position, index) for each sample.
template <class Body>
void for_samples(const SampledField& field, int threads, const Body& body) {
  const Eigen::Vector3i size = field.size();
  parallel_for(static_cast<std::size_t>(size.x()), threads, [&](std::size_t layer) {
    const int i = static_cast<int>(layer);
    for (int j = 0; j < size.y(); ++j)
      for (int k = 0; k < size.z(); ++k) body(field.position(i, j, k), field.index(i, j, k));
  });
}

}  // namespace condyle
