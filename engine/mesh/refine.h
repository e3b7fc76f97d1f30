#pragma once

#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The same surface with smaller triangles in a ball: edges that come into it are halved until none
/// is longer than `edge_mm`, or there would be more than `max_triangles`. Neighbours stay joined.
/// Vertices keep their numbers and new ones follow; colours are carried along.
TriMesh refine_near(TriMesh mesh, const Eigen::Vector3d& center, double radius_mm, double edge_mm,
                    int max_triangles = 1000000);

/// The same with a longest edge for each vertex, mm (infinite: none): edges longer than either end
/// wants are halved. New vertices want what the less demanding end of their edge does.
TriMesh refine(TriMesh mesh, std::vector<double> edge_mm, int max_triangles = 1000000);

}  // namespace condyle
