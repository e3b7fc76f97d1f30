#pragma once

#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Rims of an open surface, each its vertices one after the other as the missing triangles would
/// run; those that share a vertex are told apart. A walk that does not come back is none.
std::vector<std::vector<int>> rims_of(const TriMesh& mesh);

}  // namespace condyle
