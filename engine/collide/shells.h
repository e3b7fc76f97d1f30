#pragma once

#include <cstdint>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A connected piece of a surface.
struct Shell {
  TriMesh mesh;  // its own vertices, without colours
  bool closed =
      false;  // every edge is used equally often in both directions, and a volume is enclosed
  // One per triangle: bit k for the edge from corner k to corner k + 1 on a rim, bit 3 + k for
  // corner k on a rim. All zero for closed shells.
  std::vector<std::uint8_t> rim;
};

/// throws: InputError unless the mesh has a triangle, all coordinates are finite and all indices
/// are of its vertices.
void require_sound(const TriMesh& mesh);

/// The pieces that bound a solid. Closed shells face outward: those that face inward within another
/// shell are cavities and are omitted; others that face inward are flipped. Open shells keep their
/// orientation. The mesh must be welded.
std::vector<Shell> solid_shells(const TriMesh& mesh);

}  // namespace condyle
