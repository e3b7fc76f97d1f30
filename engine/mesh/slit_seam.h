#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The part of a slit's inside that stays.
struct SlitSeam {
  double at_ends_mm = 1, at_sides_mm = 14;
};

/// Triangles of a surface without those that lie deep behind a slit in it, as seen along +y. A
/// broad seam of the inside stays along its long sides and a narrow one at its ends, where it would
/// be stretched to a curtain when the sides part. `inside`: vertices there, such as a rim's; those
/// that are connected with them and hidden in that view count, up to `beside_mm` from `middle` in x
/// and z.
std::vector<Eigen::Vector3i> without_deep_inside(const TriMesh& surface,
                                                 std::span<const int> inside,
                                                 const Eigen::Vector3d& middle, double beside_mm,
                                                 const SlitSeam& seam = {});

}  // namespace condyle
