#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/cut/region.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A saw cut of finite reach.
struct Cut {
  std::string name;
  Region above;                // the side that is parted from the rest of what is in reach
  std::vector<Plane> reach;    // a convex volume, outward normals; empty: without end
  double kerf_mm = 0;          // thickness of the removed bone, centred on the walls; 0 to 2
  bool ends_in_bone = false;   // meant to: a slit, such as a barrel stave's
  bool stays_in_bone = false;  // between the cortices: holes in its walls are reported
};

/// Where a piece lies with respect to a cut.
enum class CutSide { neither, above, below };

/// Mark of faces where a cut ends within the bone.
constexpr int slot_end = std::numeric_limits<int>::max();

/// A part of the bone.
struct Piece {
  TriMesh mesh;             // closed, manifold, faces outward
  std::vector<int> source;  // original triangle of each face; -1 on a cut face
  std::vector<int> wall;  // on a cut face: mark of the wall, or slot_end; -1 on the bone's surface
  std::vector<CutSide> sides;  // by cut; neither: out of its reach, or not parted by it
  double volume_mm3 = 0;
};

/// A place where a cut that should stay in the bone breaks through its surface: a hole in the wall.
struct CutWindow {
  double area_mm2 = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // middle of its rim
};

/// What a cut did.
struct CutOutcome {
  bool meets_bone = false;
  bool through = false;          // no bone joins both sides
  bool open_on_purpose = false;  // not through, and meant to end in the bone
  // Otherwise: length of bone beyond the end of the cut, along its surface, and its middle.
  double left_mm = 0;
  Eigen::Vector3d left_at = Eigen::Vector3d::Zero();
  double wall_area_mm2 = 0;             // of cut faces, both sides
  std::vector<CutWindow> windows = {};  // of a cut that stays in the bone, largest first
};

struct CutResult {
  std::vector<Piece> pieces;  // largest first
  double kerf_volume_mm3 = 0;
  std::vector<CutOutcome> outcomes;  // by cut
  /// Cuts that cross in the bone, or whose kerfs run into each other. A cut that ends at another's
  /// wall or in its kerf crosses nothing.
  std::vector<std::pair<int, int>> crossings;
  int turned = 0;  // triangles of cut faces that face backward: the bone's surface crosses itself
};

/// Cuts a bone by all cuts at once. Triangles out of reach of every cut keep their corners; others
/// are divided, and their parts lie in their plane. Colours of new vertices are interpolated along
/// the edges.
/// Method: a complex of cells (see CellComplex), of which those with the same sides are joined.
/// throws: InputError for a mesh with open or unbalanced edges, and for values out of range.
CutResult cut_bone(const TriMesh& bone, std::span<const Cut> cuts);

/// Pieces of less volume are slivers.
constexpr double sliver_mm3 = 20;
/// Smaller windows are not reported.
constexpr double window_mm2 = 0.1;

}  // namespace condyle
