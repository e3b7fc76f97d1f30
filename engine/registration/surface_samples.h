#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/triangle_tree.h"

namespace condyle {

/// A point on a triangle of a surface.
struct SurfaceSample {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, outward
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  int triangle = 0;
};

/// About `count` points spread evenly over the surface's area; the same for the same mesh.
/// Empty for a surface without area.
std::vector<SurfaceSample> sample_surface(const TriMesh& mesh, int count);

/// The samples that can be seen from outside: from which one of several rays about the normal
/// leaves the surface. Walls of cavities, such as the inside of a brain case, are left out.
/// tree: of the same surface.
std::vector<SurfaceSample> outer_samples(const std::vector<SurfaceSample>& samples,
                                         const TriangleTree& tree, int threads);

}  // namespace condyle
