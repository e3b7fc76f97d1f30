#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A coarser mesh of about `target_triangles`, made of a subset of the vertices (colours kept); the
/// mesh itself when it is small enough. The mesh must be welded. A closed manifold stays closed and
/// manifold: where the edge collapses would break it, the result keeps more triangles.
TriMesh simplify(const TriMesh& mesh, int target_triangles);

/// Removes pairs of triangles back to back on the same corners, flaps without thickness, which edge
/// collapses can leave; dropping one of them would leave a hole.
void drop_flaps(std::vector<Eigen::Vector3i>& triangles);

/// What becomes of the open rims of a surface.
enum class Rims { coarser, fixed };

/// Coarser triangles on the same vertices, about `target_triangles`, with a deviation of at most
/// about `error_mm`; the given ones when there are few enough. Rims keep their shape; fixed ones
/// keep their vertices too.
std::vector<Eigen::Vector3i> coarser(std::span<const Eigen::Vector3f> positions,
                                     std::span<const Eigen::Vector3i> triangles,
                                     int target_triangles, double error_mm,
                                     Rims rims = Rims::coarser);

}  // namespace condyle
