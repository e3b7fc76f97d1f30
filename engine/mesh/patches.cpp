#include "engine/mesh/patches.h"

#include <meshoptimizer.h>

#include <cassert>

namespace condyle {

Patches cut_into_patches(std::span<const Eigen::Vector3f> positions,
                         std::span<const Eigen::Vector3i> triangles, int max_triangles) {
  assert(max_triangles >= 4 && max_triangles <= 512 && max_triangles % 4 == 0);
  // Compact patches are hidden as a whole, flat ones face away as a whole: a compromise.
  constexpr float even_weight = 0.25f;
  constexpr std::size_t max_vertices = 255;
  Patches patches;
  patches.first.push_back(0);
  if (triangles.empty()) return patches;
  std::vector<unsigned> indices;
  indices.reserve(3 * triangles.size());
  for (const auto& t : triangles)
    for (const int v : t) indices.push_back(static_cast<unsigned>(v));
  const auto most = static_cast<std::size_t>(max_triangles);
  const std::size_t bound = meshopt_buildMeshletsBound(indices.size(), max_vertices, most);
  std::vector<meshopt_Meshlet> meshlets(bound);
  std::vector<unsigned> vertices(bound * max_vertices);
  std::vector<unsigned char> corners(bound * most * 3);
  meshlets.resize(meshopt_buildMeshlets(meshlets.data(), vertices.data(), corners.data(),
                                        indices.data(), indices.size(), positions[0].data(),
                                        positions.size(), sizeof(Eigen::Vector3f), max_vertices,
                                        most, even_weight));
  patches.triangles.reserve(triangles.size());
  for (const auto& meshlet : meshlets) {
    for (unsigned t = 0; t < meshlet.triangle_count; ++t) {
      const unsigned char* corner = &corners[meshlet.triangle_offset + 3 * t];
      const auto vertex = [&](int k) {
        return static_cast<int>(vertices[meshlet.vertex_offset + corner[k]]);
      };
      patches.triangles.emplace_back(vertex(0), vertex(1), vertex(2));
    }
    patches.first.push_back(static_cast<int>(patches.triangles.size()));
  }
  return patches;
}

}  // namespace condyle
