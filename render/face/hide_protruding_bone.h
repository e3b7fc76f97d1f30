#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The triangles of a bone except those that protrude from the skin by up to 3 mm: the error of a
/// face scan and its registration. None if nothing protrudes. Near the skin's rims, such as the
/// lips, bones are legitimately visible. Kept in the user's cache folder.
std::vector<Eigen::Vector3i> hide_protruding_bone(const TriMesh& bone, const TriMesh& skin);

}  // namespace condyle
