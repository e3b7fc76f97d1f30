#include "engine/mesh/measure.h"

#include <Eigen/Geometry>
#include <cmath>

#include "engine/core/hash.h"

namespace condyle {

using Eigen::Vector3d;

Box bounding_box(const TriMesh& mesh) {
  Box box;
  for (const auto& v : mesh.vertices) box.add(v);
  return box;
}

double surface_area(const TriMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d& a = mesh.vertices[t[0]];
    sum += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
  }
  return sum / 2;
}

double signed_volume(const TriMesh& mesh) {
  if (mesh.empty()) return 0;
  // Relative to a point of the mesh: far from the origin the tetrahedra would lose digits.
  const Vector3d o = mesh.vertices[mesh.triangles[0][0]];
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += (mesh.vertices[t[0]] - o).dot((mesh.vertices[t[1]] - o).cross(mesh.vertices[t[2]] - o));
  return sum / 6;
}

std::vector<Vector3d> vertex_normals(const TriMesh& mesh) {
  std::vector<Vector3d> normals(mesh.vertices.size(), Vector3d::Zero());
  for (const auto& t : mesh.triangles) {
    const Vector3d corner[3] = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    const Vector3d cross = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double twice_area = cross.norm();
    if (!(twice_area > 0)) continue;
    for (int k = 0; k < 3; ++k) {
      const Vector3d u = corner[(k + 1) % 3] - corner[k], v = corner[(k + 2) % 3] - corner[k];
      normals[t[k]] += std::atan2(twice_area, u.dot(v)) / twice_area * cross;
    }
  }
  for (auto& n : normals) {
    const double length = n.norm();
    if (length > 0) n /= length;
  }
  return normals;
}

std::uint64_t mesh_hash(const TriMesh& mesh) {
  const std::uint64_t counts[3] = {mesh.vertices.size(), mesh.triangles.size(), mesh.colors.size()};
  std::uint64_t h = hash_values(std::span<const std::uint64_t>(counts));
  h = hash_bytes(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vector3d), h);
  h = hash_bytes(mesh.triangles.data(), mesh.triangles.size() * sizeof(Eigen::Vector3i), h);
  return hash_bytes(mesh.colors.data(), mesh.colors.size() * sizeof(Eigen::Vector3f), h);
}

}  // namespace condyle
