#include "render/face/lashes.h"

#include <Eigen/Geometry>
#include <optional>

#include "engine/mesh/topology.h"
#include "render/mesh/vertex_normals.h"

namespace condyle {
namespace {

constexpr double max_hair_mm2 = 50;  // a lash of 12 mm has a fifth of it

/// A strand of radius r has the volume r/2 times its surface. Nothing for what is no strand.
std::optional<double> radius_of_strand(const TriMesh& mesh,
                                       const std::vector<Eigen::Vector3i>& piece) {
  double area = 0, volume = 0;
  const Eigen::Vector3d& origin = mesh.vertices[static_cast<std::size_t>(piece[0][0])];
  for (const auto& t : piece) {
    const Eigen::Vector3d a = mesh.vertices[static_cast<std::size_t>(t[0])] - origin,
                          b = mesh.vertices[static_cast<std::size_t>(t[1])] - origin,
                          c = mesh.vertices[static_cast<std::size_t>(t[2])] - origin;
    area += (b - a).cross(c - a).norm() / 2;
    volume += a.dot(b.cross(c)) / 6;
  }
  const double radius = 2 * std::abs(volume) / area;
  if (area >= max_hair_mm2 || !(radius < thickest_lash_mm) || !is_closed_surface(piece))
    return std::nullopt;
  return radius;
}

std::vector<std::vector<Eigen::Vector3i>> connected_pieces(const TriMesh& mesh) {
  const Components components = find_components(mesh);
  std::vector<std::vector<Eigen::Vector3i>> pieces(static_cast<std::size_t>(components.count));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    pieces[static_cast<std::size_t>(components.of_triangle[t])].push_back(mesh.triangles[t]);
  return pieces;
}

}  // namespace

EyePieces part_lashes(const TriMesh& mesh) {
  EyePieces parted;
  for (const auto& piece : connected_pieces(mesh)) {
    auto& kind = radius_of_strand(mesh, piece) ? parted.lashes : parted.eyes;
    kind.insert(kind.end(), piece.begin(), piece.end());
  }
  return parted;
}

std::vector<float> lash_radii(const TriMesh& mesh) {
  std::vector<float> radii(mesh.vertices.size(), 0);
  for (const auto& piece : connected_pieces(mesh))
    if (const auto radius = radius_of_strand(mesh, piece))
      for (const auto& t : piece)
        for (const int v : t) radii[static_cast<std::size_t>(v)] = static_cast<float>(*radius);
  return radii;
}

}  // namespace condyle
