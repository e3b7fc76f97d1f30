#pragma once

#include <algorithm>
#include <array>

#include "engine/volume/volume.h"

namespace condyle {

/// Trilinear values of a volume; the border value continues beyond it.
class VolumeValues {
 public:
  explicit VolumeValues(const Volume& volume) : volume_(volume) {}
  double operator()(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d at =
        (volume_.axes.transpose() * (p - volume_.origin)).cwiseQuotient(volume_.spacing_mm);
    std::array<int, 3> low;
    std::array<double, 3> part;
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const double c = std::clamp(at[a], 0.0, volume_.size[axis] - 1.0);
      low[axis] = std::min(static_cast<int>(c), volume_.size[axis] - 2);
      part[axis] = c - low[axis];
    }
    const std::int16_t* v = volume_.values.data() + volume_.index(low[0], low[1], low[2]);
    const std::size_t row = static_cast<std::size_t>(volume_.size[0]),
                      slice = row * static_cast<std::size_t>(volume_.size[1]);
    const auto along = [&](const std::int16_t* u) { return u[0] + part[0] * (u[1] - u[0]); };
    const auto face = [&](const std::int16_t* u) {
      return along(u) + part[1] * (along(u + row) - along(u));
    };
    return face(v) + part[2] * (face(v + slice) - face(v));
  }
  /// Length of a voxel along a direction: that of the ellipsoid with the voxel's axes.
  double step_mm(const Eigen::Vector3d& direction) const {
    return (volume_.axes.transpose() * direction).cwiseProduct(volume_.spacing_mm).norm();
  }

 private:
  const Volume& volume_;
};

}  // namespace condyle
