#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Triangles of an eyes part, told apart: closed strands no thicker than hair are lashes.
struct EyePieces {
  std::vector<Eigen::Vector3i> eyes, lashes;
};
EyePieces part_lashes(const TriMesh& mesh);

}  // namespace condyle
