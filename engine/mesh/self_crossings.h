#pragma once

#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "engine/mesh/unfold.h"

namespace condyle {

/// The triangles through which an edge passes that has no corner in common with them, and those
/// beside such edges; ascending. Triangles that only touch do not count. Needs valid indices.
std::vector<int> self_crossings(const TriMesh& mesh, int threads = 1);

/// Takes vertices back towards where they were before a move, by halves, then wholly, until no
/// triangle near them passes through another one: a surface that crosses itself is inside out
/// there. `before`: positions (mm), of a surface without crossings, by vertex. Returns the number
/// of triangles that still cross.
std::size_t uncross(TriMesh& mesh, const std::vector<Eigen::Vector3d>& before, int threads = 1);

/// As unfold(), but vertices that would make a surface without crossings cross itself stay.
void unfold_apart(TriMesh& mesh, const UnfoldSettings& settings = {}, int threads = 1);

}  // namespace condyle
