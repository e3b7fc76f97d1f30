#pragma once

#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The same surface with smaller triangles in a ball: edges that reach into it are halved until
/// none is longer than `edge_mm`, or there would be more than `max_triangles`. Neighbours stay
/// joined. Vertices keep their numbers and new ones follow; colours are interpolated.
TriMesh refine_near(TriMesh mesh, const Eigen::Vector3d& center, double radius_mm, double edge_mm,
                    int max_triangles = 1000000);

/// The same with a longest edge for each vertex, mm (infinite: none): edges longer than the limit
/// of either end are halved. New vertices get the larger limit of their edge's ends.
TriMesh refine(TriMesh mesh, std::vector<double> edge_mm, int max_triangles = 1000000);

}  // namespace condyle
