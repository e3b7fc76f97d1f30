#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Colours of a face whose own are not known, sRGB: the red of the lips about the mouth's rim, more
/// blood in cheeks and the tip of the nose. rim: vertices one after the other round the closed
/// mouth. colors: what the face has so far, one a vertex.
void tint_skin(const TriMesh& face, std::span<const int> rim, std::vector<Eigen::Vector3f>& colors);

}  // namespace condyle
