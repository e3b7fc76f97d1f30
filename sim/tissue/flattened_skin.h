#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The mesh with a membrane in place of what lies within `reach_mm` of the points along its
/// surface: each vertex there is the mean of its neighbours, except on borders, which stay. Closes
/// pits, such as nostrils, that are too narrow for tissue below their surface.
TriMesh flattened_near(const TriMesh& mesh, const std::vector<Eigen::Vector3d>& points,
                       double reach_mm);

}  // namespace condyle
