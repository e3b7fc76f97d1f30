#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

/// The triangles of a surface, cut into patches of neighbours with similar normals: patch k is the
/// range from `first[k]` to `first[k + 1]`.
struct Patches {
  std::vector<Eigen::Vector3i> triangles;  // each once, its corners in their order
  std::vector<int> first;                  // one more than there are patches; {0} for no triangles
};

/// max_triangles: of a patch, a multiple of 4 from 4 to 512.
Patches cut_into_patches(std::span<const Eigen::Vector3f> positions,
                         std::span<const Eigen::Vector3i> triangles, int max_triangles);

}  // namespace condyle
