#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "engine/collide/box_bound.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A binary tree of oriented boxes around the triangles of a surface, along the principal axes of
/// their corners, one triangle in each leaf.
struct BoxTree {
  /// The mesh must be sound (require_sound) and have a triangle.
  explicit BoxTree(const TriMesh& mesh);

  /// The same, kept in a cache folder where the mesh is large: read in a tenth of the time.
  static BoxTree stored(const TriMesh& mesh, const std::filesystem::path& cache);

  /// At this depth the tree is divided into regions of its surface.
  static constexpr int region_depth = 6;
  static constexpr int region_count = 1 << region_depth;

  std::vector<BoxPair> boxes;  // the root alone, then the children of each inner node
  std::vector<std::array<signed char, 2>> region;  // of each box; -1 above the cut
  double reach_mm = 0;                             // no corner of a box is farther from the origin

 private:
  BoxTree() = default;
};

/// Contents of a box: a triangle, or the index of its children's boxes.
inline int holding_triangle(int triangle) { return -1 - triangle; }
inline bool holds_triangle(int held) { return held < 0; }
inline int held_triangle(int held) { return -1 - held; }

}  // namespace condyle
