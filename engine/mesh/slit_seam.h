#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// What stays of a slit's inside.
struct SlitSeam {
  double at_ends_mm = 1, at_sides_mm = 14;
};

/// Triangles of a surface without what lies deep behind a slit in it, as seen along +y: of its long
/// sides a broad seam of the inside stays, at its ends a narrow one, which would be drawn out to a
/// curtain where the sides part. `inside`: vertices there, such as a rim's; what hangs together
/// with them and is hidden in that view counts, up to `beside_mm` from `middle` in x and z.
std::vector<Eigen::Vector3i> without_deep_inside(const TriMesh& surface,
                                                 std::span<const int> inside,
                                                 const Eigen::Vector3d& middle, double beside_mm,
                                                 const SlitSeam& seam = {});

}  // namespace condyle
