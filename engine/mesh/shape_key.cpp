#include "engine/mesh/shape_key.h"

#include "engine/core/user_cache.h"

namespace condyle {

std::uint64_t shape_key(const TriMesh& mesh, std::uint64_t h) {
  const std::uint64_t counts[2] = {mesh.vertices.size(), mesh.triangles.size()};
  h = word_hash(counts, sizeof counts, h);
  h = word_hash(mesh.vertices.data(), mesh.vertices.size() * sizeof mesh.vertices[0], h);
  return word_hash(mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0], h);
}

}  // namespace condyle
