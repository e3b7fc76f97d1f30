#include "render/face/hide_protruding_bone.h"

#include <algorithm>
#include <cstdint>

#include "engine/core/archive.h"
#include "engine/core/user_cache.h"
#include "engine/mesh/rims.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

std::uint64_t hash_of(const TriMesh& mesh, std::uint64_t h) {
  const std::size_t sizes[] = {mesh.vertices.size(), mesh.triangles.size()};
  h = word_hash(sizes, sizeof sizes, h);
  h = word_hash(mesh.vertices.data(), sizes[0] * sizeof mesh.vertices[0], h);
  return word_hash(mesh.triangles.data(), sizes[1] * sizeof mesh.triangles[0], h);
}

std::vector<Eigen::Vector3i> triangles_beneath(const TriMesh& bone, const TriMesh& skin) {
  constexpr double max_mm = 3;
  const TriangleTree tree(skin);
  std::vector<char> rim(skin.vertices.size(), 0), out(bone.vertices.size(), 0);
  for (const auto& walk : rims_of(skin))
    for (const int v : walk) rim[static_cast<std::size_t>(v)] = 1;
  for (std::size_t v = 0; v < out.size(); ++v) {
    const auto near = tree.signed_nearest(bone.vertices[v], max_mm);
    if (near.triangle < 0 || near.distance <= 0) continue;
    const auto& corners = skin.triangles[static_cast<std::size_t>(near.triangle)];
    out[v] = std::none_of(corners.begin(), corners.end(),
                          [&](int c) { return rim[static_cast<std::size_t>(c)]; });
  }
  std::vector<Eigen::Vector3i> kept;
  for (const auto& t : bone.triangles)
    if (std::none_of(t.begin(), t.end(), [&](int v) { return out[static_cast<std::size_t>(v)]; }))
      kept.push_back(t);
  if (kept.size() == bone.triangles.size()) kept.clear();
  return kept;
}

}  // namespace

std::vector<Eigen::Vector3i> hide_protruding_bone(const TriMesh& bone, const TriMesh& skin) {
  const ResultCache results(user_cache_folder(), "beneath-skin");
  const std::uint64_t inputs = hash_of(skin, hash_of(bone, hash_start));
  std::vector<Eigen::Vector3i> kept;
  if (const auto bytes = results.read(inputs)) {
    ArchiveReader reader(*bytes);
    reader(kept);
    if (reader.complete()) return kept;
  }
  kept = triangles_beneath(bone, skin);
  ArchiveWriter writer;
  writer(kept);
  results.write(inputs, writer.take());
  return kept;
}

}  // namespace condyle
