#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Colours for a face without colours, sRGB: the vermilion of the lips around the mouth's rim,
/// redder cheeks and tip of the nose. rim: vertices in order around the closed mouth. colors: the
/// present colours, one per vertex.
void tint_skin(const TriMesh& face, std::span<const int> rim, std::vector<Eigen::Vector3f>& colors);

}  // namespace condyle
