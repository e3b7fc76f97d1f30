#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Triangles of a face without what lies deep behind the lips, from its rim there on (vertices of
/// the face, around the mouth): of a lip a broad seam stays, of the corners of the mouth a narrow
/// one, which would be drawn out to a curtain between the jaws. All of them where there is no such
/// seam. The face looks to -y.
std::vector<Eigen::Vector3i> without_deep_inside(const TriMesh& face, std::span<const int> rim,
                                                 double middle_x);

}  // namespace condyle
