#pragma once

#include <array>
#include <utility>
#include <vector>

#include "engine/cut/cell_complex.h"
#include "engine/cut/cell_sides.h"

namespace condyle {

/// The connected parts of a divided complex.
struct JoinedCells {
  int parts = 0;
  // Part on the front and on the back of each face; -1: air or kerf.
  std::vector<std::array<int, 2>> of_face;
};

/// Joins cells across the faces between them unless a cut runs there, and the faces of a cell that
/// share an edge. Parts are numbered by their first face.
JoinedCells join_cells(const CellComplex& complex, const CellSides& sides);

}  // namespace condyle
