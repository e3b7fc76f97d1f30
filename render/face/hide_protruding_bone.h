#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The triangles of a bone except those that protrude from the skin by up to 3 mm: the error of a
/// face scan and its registration. None if nothing is left out. Near the skin's rims, such as the
/// lips, bones are legitimately visible. in_place: the bone lies as it does at rest; what lies up
/// to 5 mm below the skin, 25 mm or more from its rims, is left out too, because skin that slides
/// over it, such as a raised brow, may expose it. Kept in the user's cache folder.
std::optional<std::vector<Eigen::Vector3i>> hide_protruding_bone(const TriMesh& bone,
                                                                 const TriMesh& skin,
                                                                 bool in_place);

}  // namespace condyle
