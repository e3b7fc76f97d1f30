#pragma once

#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Merges into one vertex all that lie within `tolerance_mm` of an earlier one (0: of equal
/// coordinates); position and colour are those of the first. Triangles keep their number and order;
/// vertices without a triangle stay. Returns the number of removed vertices.
int weld(TriMesh& mesh, double tolerance_mm = 0);

/// Drops triangles that repeat a corner, and flat ones (three corners on a line): where a flat one
/// has its long edge on a neighbour, the neighbour is split so that no crack opens.
/// Returns the number of removed triangles.
int drop_degenerate(TriMesh& mesh);

/// Keeps the first of triangles with the same three corners, in any order.
int drop_duplicates(TriMesh& mesh);

/// Drops vertices that no triangle uses; the order of the others stays.
int drop_unreferenced(TriMesh& mesh);

/// Flips every triangle.
void flip(TriMesh& mesh);

struct Orientation {
  int turned = 0;          // flipped triangles
  int inward_closed = 0;   // closed components that faced inward
  int contradictions = 0;  // edges that cannot agree (a one-sided or knotted surface)
};

/// Makes neighbours agree and closed components face outward. A closed component inside another
/// keeps its sense relative to its container: a cavity stays a cavity. An open component keeps the
/// sense of the larger part of its area.
Orientation orient_outward(TriMesh& mesh);

}  // namespace condyle
