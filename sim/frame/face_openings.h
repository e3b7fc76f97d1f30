#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A hole that a segmentation leaves in a face at an eye or a nostril.
struct FaceOpening {
  enum class Kind { eye, nostril };
  Kind kind;
  std::vector<int> rim;  // in the direction of the missing triangles
  Eigen::Vector3d middle = {0, 0, 0}, outward = {0, 0, 0};  // of the rim; the latter unit
};

/// Recognized by size, position relative to the tip of the nose, and direction; LPS.
std::vector<FaceOpening> find_openings(const TriMesh& face);

}  // namespace condyle
