#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "engine/volume/volume.h"

namespace condyle {

/// Voxels low, ..., low + size - 1 of a volume; it may reach beyond the volume.
struct VoxelBox {
  std::array<int, 3> low = {0, 0, 0};
  std::array<int, 3> size = {0, 0, 0};

  std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }
  bool empty() const { return size[0] <= 0 || size[1] <= 0 || size[2] <= 0; }
  /// By the place in the box; the first axis is fastest.
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(i);
  }
  Eigen::Vector3d position(const Volume& volume, double i, double j, double k) const {
    return volume.position(low[0] + i, low[1] + j, low[2] + k);
  }
  /// Larger by so many voxels at all sides.
  VoxelBox grown(int by) const {
    VoxelBox box = *this;
    for (std::size_t a = 0; a < 3; ++a) box.low[a] -= by, box.size[a] += 2 * by;
    return box;
  }
  VoxelBox within(const VoxelBox& other) const {
    VoxelBox box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] = std::max(low[a], other.low[a]);
      box.size[a] = std::min(low[a] + size[a], other.low[a] + other.size[a]) - box.low[a];
    }
    return box;
  }
};

/// All voxels of a volume.
inline VoxelBox whole_box(const Volume& volume) { return {{0, 0, 0}, volume.size}; }

}  // namespace condyle
