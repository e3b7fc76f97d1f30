#include "engine/segmentation/voxel_pieces.h"

#include <algorithm>

#include "engine/core/disjoint_sets.h"

namespace condyle {
namespace {

using Size = std::array<int, 3>;

/// Joins the runs of two rows that overlap, or that lie at most `slack` apart.
template <class Join>
void join_rows(const VoxelPieces& pieces, std::size_t row, std::size_t other, int slack,
               const Join& join) {
  std::size_t a = pieces.row_start[row], b = pieces.row_start[other];
  const std::size_t a_end = pieces.row_start[row + 1], b_end = pieces.row_start[other + 1];
  while (a < a_end && b < b_end) {
    const VoxelRun &p = pieces.runs[a], &q = pieces.runs[b];
    if (p.first <= q.last + slack && q.first <= p.last + slack) join(a, b);
    if (p.last < q.last)
      ++a;
    else
      ++b;
  }
}

void find_runs(const std::vector<std::uint8_t>& mask, const Size& size, std::uint8_t value,
               VoxelPieces& pieces) {
  const std::size_t rows = static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  pieces.row_start.reserve(rows + 1);
  for (std::size_t row = 0; row < rows; ++row) {
    pieces.row_start.push_back(pieces.runs.size());
    const std::uint8_t* at = mask.data() + row * static_cast<std::size_t>(size[0]);
    for (int i = 0; i < size[0]; ++i) {
      if (at[i] != value) continue;
      const int first = i;
      while (i + 1 < size[0] && at[i + 1] == value) ++i;
      pieces.runs.push_back({first, i, 0});
    }
  }
  pieces.row_start.push_back(pieces.runs.size());
}

}  // namespace

VoxelPieces find_pieces(const std::vector<std::uint8_t>& mask, const Size& size, std::uint8_t value,
                        Connectivity connectivity) {
  VoxelPieces pieces;
  find_runs(mask, size, value, pieces);
  DisjointSets sets(pieces.runs.size());
  const auto join = [&](std::size_t a, std::size_t b) {
    sets.join(static_cast<int>(a), static_cast<int>(b));
  };
  const bool corners = connectivity == Connectivity::corners;
  const int slack = corners ? 1 : 0;
  const auto row_of = [&](int j, int k) {
    return static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) +
           static_cast<std::size_t>(j);
  };
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j) {
      const std::size_t row = row_of(j, k);
      if (j > 0) join_rows(pieces, row, row_of(j - 1, k), slack, join);
      if (k == 0) continue;
      join_rows(pieces, row, row_of(j, k - 1), slack, join);
      if (corners && j > 0) join_rows(pieces, row, row_of(j - 1, k - 1), slack, join);
      if (corners && j + 1 < size[1]) join_rows(pieces, row, row_of(j + 1, k - 1), slack, join);
    }

  std::vector<int> number(pieces.runs.size(), -1);
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j) {
      const std::size_t row = row_of(j, k);
      const bool edge = j == 0 || k == 0 || j + 1 == size[1] || k + 1 == size[2];
      for (std::size_t r = pieces.row_start[row]; r < pieces.row_start[row + 1]; ++r) {
        VoxelRun& run = pieces.runs[r];
        int& found = number[static_cast<std::size_t>(sets.find(static_cast<int>(r)))];
        if (found < 0) {
          found = static_cast<int>(pieces.voxels.size());
          pieces.voxels.push_back(0);
          pieces.at_border.push_back(0);
        }
        run.piece = found;
        const auto piece = static_cast<std::size_t>(found);
        pieces.voxels[piece] += static_cast<std::size_t>(run.last - run.first + 1);
        if (edge || run.first == 0 || run.last + 1 == size[0]) pieces.at_border[piece] = 1;
      }
    }
  return pieces;
}

}  // namespace condyle
