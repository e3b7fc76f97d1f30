#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Triangles of a bone without those that stand out of the skin by up to 3 mm: as much as a face
/// scan and its registration err by, and less than to be missed. None if that leaves out nothing.
/// Near the skin's rims, such as the lips, bones are what is seen there.
std::vector<Eigen::Vector3i> beneath_skin(const TriMesh& bone, const TriMesh& skin);

}  // namespace condyle
