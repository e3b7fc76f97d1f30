#include "render/face/hide_protruding_bone.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>

#include "engine/core/archive.h"
#include "engine/core/user_cache.h"
#include "engine/mesh/rims.h"
#include "engine/mesh/shape_key.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

constexpr double protrudes_mm = 3, thin_mm = 5;
constexpr double opening_mm = 25;  // from a rim of the skin: bone may show through the opening
constexpr double lengths[] = {protrudes_mm, thin_mm, opening_mm};

using Kept = std::optional<std::vector<Eigen::Vector3i>>;

Kept kept_triangles(const TriMesh& bone, const TriMesh& skin, bool in_place) {
  std::vector<char> rim(skin.vertices.size(), 0), hidden(bone.vertices.size(), 0);
  for (const auto& walk : rims_of(skin))
    for (const int v : walk) rim[static_cast<std::size_t>(v)] = 1;
  const auto meets_rim = [&](const Eigen::Vector3i& t) {
    return std::any_of(t.begin(), t.end(), [&](int v) { return rim[static_cast<std::size_t>(v)]; });
  };
  TriMesh border;
  border.vertices = skin.vertices;
  std::copy_if(skin.triangles.begin(), skin.triangles.end(), std::back_inserter(border.triangles),
               meets_rim);
  const TriangleTree tree(skin), border_tree(border);
  for (std::size_t v = 0; v < hidden.size(); ++v) {
    const Eigen::Vector3d& p = bone.vertices[v];
    const auto near = tree.signed_nearest(p, thin_mm);
    if (near.triangle < 0 || near.distance > protrudes_mm) continue;
    if (near.distance > 0)
      hidden[v] = !meets_rim(skin.triangles[static_cast<std::size_t>(near.triangle)]);
    else
      hidden[v] = in_place && border_tree.nearest(p, opening_mm).triangle < 0;
  }
  std::vector<Eigen::Vector3i> kept;
  for (const auto& t : bone.triangles)
    if (std::none_of(t.begin(), t.end(),
                     [&](int v) { return hidden[static_cast<std::size_t>(v)]; }))
      kept.push_back(t);
  if (kept.size() == bone.triangles.size()) return std::nullopt;
  return kept;
}

}  // namespace

std::optional<std::vector<Eigen::Vector3i>> hide_protruding_bone(const TriMesh& bone,
                                                                 const TriMesh& skin,
                                                                 bool in_place) {
  const ResultCache results(user_cache_folder(), "bone-below-skin");
  const std::uint64_t rules = word_hash(lengths, in_place ? sizeof lengths : 0, hash_start);
  const std::uint64_t inputs = shape_key(skin, shape_key(bone, rules));
  Kept kept;
  if (const auto bytes = results.read(inputs)) {
    ArchiveReader reader(*bytes);
    reader(kept);
    if (reader.complete()) return kept;
  }
  kept = kept_triangles(bone, skin, in_place);
  ArchiveWriter writer;
  writer(kept);
  results.write(inputs, writer.take());
  return kept;
}

}  // namespace condyle
