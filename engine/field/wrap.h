#pragma once

#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct WrapOptions {
  double spacing_mm = 0.4;      // of the grid; see WrappedSurface for the one that was used
  int most_triangles = 400000;  // about, before simplification
  int threads = 1;              // the result is bit-identical for any number
};

/// A closed surface about another, and how far they lie from each other.
struct WrappedSurface {
  TriMesh mesh;           // closed, manifold, facing outward
  double spacing_mm = 0;  // of the grid: coarser for large surfaces, finer for small ones
  int solids = 0;         // components that face outward
  // Distance of points of the original's outer surface from the wrapped one.
  double largest_mm = 0, mean_mm = 0;
  // Farthest point of the wrapped surface from the original one: middle of a closed opening.
  double opening_mm = 0;
};

/// A closed surface close to one that is open, or whose parts disagree on outside. Its inside is
/// where the generalised winding number is above one half (Jacobson, Kavan and Sorkine-Hornung
/// 2013), so openings are closed by smooth lids. Sheets that enclose nothing, and plates that are
/// thinner than the grid can show, become plates of about 1.5 times the spacing. It has about as
/// many triangles as the original, at least 8000. Parts of less than 20 mm^3 are dropped, colours
/// too. The mesh must be welded. `mesh` of the result is empty where nothing is enclosed.
WrappedSurface wrap(const TriMesh& mesh, const WrapOptions& options = {});

}  // namespace condyle
