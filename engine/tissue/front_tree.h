#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/tissue/elimination_order.h"

namespace condyle {

/// Storage layout of a block matrix and its Cholesky factor: columns with nearly the same rows form
/// a front (supernode), a dense panel. Computed once per pattern.
struct FrontTree {
  /// `ring`: as for the order; `block`: rows of a block.
  FrontTree(const std::vector<std::vector<int>>& ring, EliminationOrder order, int block);

  struct Front {
    int first = 0, pivots = 0;         // eliminated places, in blocks
    int rows_begin = 0, rows_end = 0;  // the places below, in `rows`, ascending
    int parent = -1;                   // front, or -1
    std::size_t panel = 0;             // first float; (pivots + rows) * block of each column
    std::size_t tiles = 0;             // first tile (see FrontKernels)
    std::size_t update = 0;  // first float of the update matrix for the parent, in work space
    std::vector<int> children;
  };
  /// Floats from one column of a front's panel to the next, and of its update.
  int height(const Front& f) const { return (f.pivots + f.rows_end - f.rows_begin) * block; }
  int update_height(const Front& f) const { return (f.rows_end - f.rows_begin) * block; }
  /// Panel's first float of the block (row, column); places, row >= column. -1 if not stored.
  std::ptrdiff_t find(int row, int column) const;
  /// Multiplications of a factorization.
  double multiplications() const;

  static constexpr int beyond =
      16;  // floats of padding that vector kernels may access after each part

  int block = 0;
  EliminationOrder order;
  std::vector<int> place;  // vertex -> place
  std::vector<Front> fronts;
  std::array<int, 4> part{};  // fronts of the order's three parts
  std::vector<int> front_of;  // place -> front
  std::vector<int> rows;      // of all fronts
  std::vector<int> seat;      // per entry of `rows`: its block in the parent's rows
  std::vector<int>
      run_end;  // per entry of `rows`: end of the range that is contiguous in the parent as well
  std::vector<int> row_end;  // per entry of `rows`: end of the range of consecutive places
  std::size_t panel_floats = 0, work_floats = 0, tiles = 0;
  int most_height = 0;  // of any front

 private:
  /// Consecutive columns that become one front.
  struct ColumnRange {
    int first, last;
    long entries;  // of the factor in these columns
  };
  /// Merges a column into the preceding ones where that stores few zeros; counts the fronts of each
  /// part. `below`: the rows below the diagonal of each column, ascending.
  std::vector<ColumnRange> merge_columns(const std::vector<std::vector<int>>& below);
  void make_fronts(const std::vector<ColumnRange>& ranges,
                   const std::vector<std::vector<int>>& below);
  /// Parents and children of the fronts, and where the rows of each lie in its parent.
  void link_to_parents();
  /// Offsets of the update matrices in work space. Both halves run concurrently and leave their
  /// updates to the last part: one region for each.
  void place_updates();
};

}  // namespace condyle
