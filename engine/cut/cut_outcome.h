#pragma once

#include <span>
#include <utility>
#include <vector>

#include "engine/cut/cell_complex.h"
#include "engine/cut/cell_sides.h"
#include "engine/cut/cut.h"
#include "engine/cut/join_cells.h"

namespace condyle {

/// Where each part lies with respect to each cut. shape: parts x cuts.
struct PartSides {
  std::vector<std::vector<CutSide>> sides;
  std::vector<char> joins_both;  // by cut: a part lies on both of its sides
};
PartSides find_part_sides(const CellComplex& complex, const CellSides& sides,
                          const JoinedCells& joined);

/// What each cut did.
std::vector<CutOutcome> find_outcomes(const CellComplex& complex, const CellSides& sides,
                                      const JoinedCells& joined, const PartSides& parts,
                                      const TriMesh& bone, std::span<const Cut> cuts);

/// Pairs of cuts whose walls cross in the bone.
std::vector<std::pair<int, int>> find_crossings(const CellComplex& complex, const CellSides& sides);

}  // namespace condyle
