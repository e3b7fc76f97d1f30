#pragma once

#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct ClosedHoles {
  int holes = 0;
  double longest_rim_mm = 0;
};

/// Definition of a small hole: a short rim (of at most 64 edges), or one of few edges, where a
/// coarse surface lacks a few triangles.
struct SmallHole {
  double rim_mm = 15;
  int few_edges = 8;
  double few_edges_rim_mm = 30;
};

/// Closes small holes, each by the triangulation of least area between its corners (Barequet and
/// Sharir 1995); no vertex is added and no edge gets a third triangle. The cover has at most a
/// quarter of its component's area. Rims that meet in a vertex are separate holes. Neighbours must
/// agree on outside (`orient_outward`); a rim where they do not is left open.
ClosedHoles close_small_holes(TriMesh& mesh, const SmallHole& small = {});

}  // namespace condyle
