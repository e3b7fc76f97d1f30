#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A hole that a segmentation leaves in a face where an eye or a nostril is.
struct FaceOpening {
  enum class Kind { eye, nostril };
  Kind kind;
  std::vector<int> rim;                                     // as the missing triangles would run
  Eigen::Vector3d middle = {0, 0, 0}, outward = {0, 0, 0};  // of the rim; the latter unit
};

/// Told by size, place beside the tip of the nose and the way they look; in LPS.
std::vector<FaceOpening> find_openings(const TriMesh& face);

}  // namespace condyle
