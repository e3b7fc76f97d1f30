#include "render/face/hide_protruding_bone.h"

#include <algorithm>

#include "engine/mesh/rims.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {

std::vector<Eigen::Vector3i> hide_protruding_bone(const TriMesh& bone, const TriMesh& skin) {
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

}  // namespace condyle
