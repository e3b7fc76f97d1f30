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

constexpr float thickest_lash_mm = 0.25f;  // its mean radius
/// Mean radius of the lash that each vertex belongs to, mm; 0 for the others.
std::vector<float> lash_radii(const TriMesh& mesh);

}  // namespace condyle
