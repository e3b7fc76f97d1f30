#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "engine/volume/volume.h"

// Slices of a scan and the metal in them. Only for this module.
namespace condyle {

constexpr double least_metal_mm2 = 4;  // in a slice: less throws no streaks

/// A slice of a lattice across an axis: places of its pixels.
struct SliceLattice {
  std::array<std::size_t, 2> axes;  // in the slice
  std::size_t axis;
  std::array<int, 3> size;  // of the flat lattice
  Eigen::Vector3d spacing_mm;

  SliceLattice(int across, const std::array<int, 3>& whole, const Eigen::Vector3d& spacing)
      : axes{across == 0 ? 1u : 0u, across == 2 ? 1u : 2u},
        axis(static_cast<std::size_t>(across)),
        size{whole[axes[0]], whole[axes[1]], 1},
        spacing_mm(spacing[static_cast<int>(axes[0])], spacing[static_cast<int>(axes[1])], 1) {}
  std::size_t pixels() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  }
  /// Place in the whole lattice of a pixel of a slice.
  std::array<int, 3> place(std::size_t pixel, int slice) const {
    std::array<int, 3> at;
    at[axes[0]] = static_cast<int>(pixel) % size[0];
    at[axes[1]] = static_cast<int>(pixel) / size[0];
    at[axis] = slice;
    return at;
  }
};

/// The axis of the lattice that is nearest to the vertical: that of the slices of a CT.
int slice_axis(const Volume& volume);

/// Least value of metal, HU: above enamel, or the end of the scanner's range.
int metal_level(const Volume& volume);

}  // namespace condyle
