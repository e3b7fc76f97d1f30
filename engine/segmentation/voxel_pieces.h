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

}  // namespace condyle
