#pragma once

#include <cstdint>

#include "engine/core/hash.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Key of a cache for what depends on vertices and triangles alone. Chain by passing the previous
/// key.
std::uint64_t shape_key(const TriMesh& mesh, std::uint64_t h = hash_start);

}  // namespace condyle
