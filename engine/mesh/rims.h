#pragma once

#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Rims of an open surface, each as its vertices in the order of the missing triangles; rims that
/// share a vertex are separated. A walk that does not close is not a rim.
std::vector<std::vector<int>> rims_of(const TriMesh& mesh);

}  // namespace condyle
