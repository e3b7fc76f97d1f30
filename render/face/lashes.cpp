#include "render/face/lashes.h"

#include <Eigen/Geometry>

#include "engine/mesh/topology.h"
#include "render/mesh/vertex_normals.h"

namespace condyle {
namespace {

constexpr double hair_mm = 0.5;      // maximum thickness
constexpr double max_hair_mm2 = 50;  // a lash of 12 mm has a fifth of it

/// A strand of radius r has the volume r/2 times its surface.
bool is_strand(const TriMesh& mesh, const std::vector<Eigen::Vector3i>& piece) {
  double area = 0, volume = 0;
  const Eigen::Vector3d& origin = mesh.vertices[static_cast<std::size_t>(piece[0][0])];
  for (const auto& t : piece) {
    const Eigen::Vector3d a = mesh.vertices[static_cast<std::size_t>(t[0])] - origin,
                          b = mesh.vertices[static_cast<std::size_t>(t[1])] - origin,
                          c = mesh.vertices[static_cast<std::size_t>(t[2])] - origin;
    area += (b - a).cross(c - a).norm() / 2;
    volume += a.dot(b.cross(c)) / 6;
  }
  return area < max_hair_mm2 && std::abs(volume) < hair_mm / 4 * area && is_closed_surface(piece);
}

}  // namespace

EyePieces part_lashes(const TriMesh& mesh) {
  const Components components = find_components(mesh);
  std::vector<std::vector<Eigen::Vector3i>> pieces(static_cast<std::size_t>(components.count));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    pieces[static_cast<std::size_t>(components.of_triangle[t])].push_back(mesh.triangles[t]);
  EyePieces parted;
  for (const auto& piece : pieces) {
    auto& kind = is_strand(mesh, piece) ? parted.lashes : parted.eyes;
    kind.insert(kind.end(), piece.begin(), piece.end());
  }
  return parted;
}

}  // namespace condyle
