#include "sim/operation/closed_bone.h"

#include <fmt/format.h>

#include <numeric>

#include "engine/core/error.h"
#include "engine/cut/cell_complex.h"
#include "engine/mesh/holes.h"
#include "engine/mesh/repair.h"

namespace condyle {
namespace {

/// Drops triangles that repeat a corner, with their sources.
void drop_collapsed(ClosedBone& bone) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < bone.mesh.triangles.size(); ++i) {
    const Eigen::Vector3i t = bone.mesh.triangles[i];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    bone.mesh.triangles[kept] = t;
    bone.source[kept++] = bone.source[i];
  }
  bone.mesh.triangles.resize(kept);
  bone.source.resize(kept);
}

}  // namespace

ClosedBone closed_bone(const Part& part) {
  ClosedBone bone{part.mesh, std::vector<int>(part.mesh.triangles.size()), {}};
  std::iota(bone.source.begin(), bone.source.end(), 0);
  const int open = unbalanced_edges(bone.mesh);
  if (open == 0) return bone;
  weld(bone.mesh);
  drop_collapsed(bone);
  orient_outward(bone.mesh);
  const ClosedHoles closed = close_small_holes(bone.mesh);
  orient_outward(bone.mesh);
  bone.source.resize(bone.mesh.triangles.size(), -1);
  if (const int left = unbalanced_edges(bone.mesh); left > 0)
    throw InputError(
        fmt::format("{} cannot be cut: its surface is open or turned at {} edges, {} before small "
                    "holes were closed; close it in the program that made it",
                    part.name, left, open));
  bone.notes.push_back(fmt::format(
      "{}: open or turned at {} edges; welded and oriented{}", part.name, open,
      closed.holes == 0 ? std::string()
                        : fmt::format(", {} hole{} closed, the longest rim {:.1f} mm", closed.holes,
                                      closed.holes == 1 ? "" : "s", closed.longest_rim_mm)));
  return bone;
}

}  // namespace condyle
