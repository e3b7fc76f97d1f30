#pragma once

#include <span>
#include <vector>

#include "engine/cut/cell_complex.h"
#include "engine/cut/cut.h"

namespace condyle {

/// Where a cell lies with respect to a cut.
enum class CellSide : signed char { outside, above, below, kerf };

/// The sides of all cells of a complex, divided by all cuts.
struct CellSides {
  int cuts = 0;
  std::vector<CellSide> sides;  // by cell and cut

  CellSide of(int cell, int cut) const {
    return sides[static_cast<std::size_t>(cell) * cuts + cut];
  }
  bool is_kerf(int cell) const {
    for (int cut = 0; cut < cuts; ++cut)
      if (of(cell, cut) == CellSide::kerf) return true;
    return false;
  }
  /// Whether a cut runs between two cells that are not kerf.
  bool are_parted(int a, int b) const {
    for (int cut = 0; cut < cuts; ++cut)
      if (of(a, cut) != CellSide::outside && of(b, cut) != CellSide::outside &&
          of(a, cut) != of(b, cut))
        return true;
    return false;
  }
};

/// Divides the complex by all planes of the cuts.
CellSides divide_cells(CellComplex& complex, std::span<const Cut> cuts);

}  // namespace condyle
