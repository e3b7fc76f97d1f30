#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Separates the triangles of an eyes part: closed strands no thicker than a hair are lashes.
struct EyePieces {
  std::vector<Eigen::Vector3i> eyes, lashes;
};
EyePieces part_lashes(const TriMesh& mesh);

}  // namespace condyle
