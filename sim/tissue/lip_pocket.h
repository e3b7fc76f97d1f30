#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Scans of closed mouths often have a pocket between the lips, whose walls belong to one lip or
/// the other: they part along its bottom, not where a plane cuts the walls.

/// Vertices along edges, from the right corner of the mouth to the left, where the pocket is
/// deepest; empty where there is none, or where a hole is in the way. right, middle, left: of the
/// line where the lips meet, mm. The face looks to -y.
std::vector<int> pocket_bottom(const TriMesh& face, const Eigen::Vector3d& right,
                               const Eigen::Vector3d& middle, const Eigen::Vector3d& left);

/// Cuts a surface along a run of its edges, none at a border: all vertices but the ends get a twin
/// (at the end of the list; colours too), which the triangles to the right of the run, seen from
/// outside, use.
void cut_along(const std::vector<int>& run, TriMesh& surface);

}  // namespace condyle
