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

/// Whether a face is a wall of a cut: it parts two sides, or bone and kerf.
bool is_wall_of(const CellSides& sides, const CellFace& face, int cut);

/// The holes in the walls of a cut, largest first.
std::vector<CutWindow> find_windows(const CellComplex& complex, const CellSides& sides, int cut);

/// Pairs of cuts that cross in the bone, or whose kerfs run into each other. Where a cut ends at
/// another, their common kerf reaches no more than about a kerf from that end.
std::vector<std::pair<int, int>> find_crossings(const CellComplex& complex, const CellSides& sides,
                                                std::span<const Cut> cuts);

}  // namespace condyle
