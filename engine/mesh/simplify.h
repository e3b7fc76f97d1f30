#pragma once

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A coarser mesh of about `target_triangles`, made of a subset of the vertices (colours kept); the
/// mesh itself when it is small enough. The mesh must be welded. A closed manifold stays closed and
/// manifold: where the edge collapses would break it, the result keeps more triangles.
TriMesh simplify(const TriMesh& mesh, int target_triangles);

}  // namespace condyle
