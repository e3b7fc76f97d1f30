#include "engine/mesh/pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>

#include "engine/mesh/repair.h"

namespace condyle {

using Eigen::Vector3d;

std::vector<double> component_areas(const TriMesh& mesh, const Components& components) {
  std::vector<double> areas(static_cast<std::size_t>(components.count), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    const Vector3d& a = mesh.vertices[corners[0]];
    areas[components.of_triangle[t]] +=
        0.5 * (mesh.vertices[corners[1]] - a).cross(mesh.vertices[corners[2]] - a).norm();
  }
  return areas;
}

std::vector<double> component_volumes(const TriMesh& mesh, const Components& components) {
  std::vector<double> volumes(static_cast<std::size_t>(components.count), 0);
  // Relative to a point of the mesh: far from the origin the tetrahedra would lose digits.
  const Vector3d o = mesh.empty() ? Vector3d::Zero() : mesh.vertices[mesh.triangles[0][0]];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    volumes[components.of_triangle[t]] +=
        (mesh.vertices[corners[0]] - o)
            .dot((mesh.vertices[corners[1]] - o).cross(mesh.vertices[corners[2]] - o)) /
        6;
  }
  return volumes;
}

int drop_components_below(TriMesh& mesh, const Components& components,
                          const std::vector<double>& size, double least) {
  assert(size.size() == static_cast<std::size_t>(components.count));
  assert(components.of_triangle.size() == mesh.triangles.size());
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (size[components.of_triangle[t]] >= least) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
  drop_unreferenced(mesh);
  return static_cast<int>(
      std::count_if(size.begin(), size.end(), [&](double s) { return s < least; }));
}

}  // namespace condyle
