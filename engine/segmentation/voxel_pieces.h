#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace condyle {

/// Voxels first, ..., last of one row.
struct VoxelRun {
  int first = 0, last = 0;
  int piece = 0;
};

/// Connected pieces of the voxels that have one value.
struct VoxelPieces {
  std::vector<VoxelRun> runs;           // by row, from left to right
  std::vector<std::size_t> row_start;   // first run of each row; one more at the end
  std::vector<std::size_t> voxels;      // number in each piece
  std::vector<std::uint8_t> at_border;  // whether a piece reaches the border of the lattice
};

enum class Connectivity { faces, corners };

/// Pieces are numbered by their first voxel. The first axis of the lattice is fastest.
VoxelPieces find_pieces(const std::vector<std::uint8_t>& mask, const std::array<int, 3>& size,
                        std::uint8_t value, Connectivity connectivity);

/// Calls change(first voxel, run) for each run.
template <class Change>
void for_runs(const VoxelPieces& pieces, int row_size, const Change& change) {
  for (std::size_t row = 0; row + 1 < pieces.row_start.size(); ++row)
    for (std::size_t r = pieces.row_start[row]; r < pieces.row_start[row + 1]; ++r)
      change(
          row * static_cast<std::size_t>(row_size) + static_cast<std::size_t>(pieces.runs[r].first),
          pieces.runs[r]);
}

}  // namespace condyle
