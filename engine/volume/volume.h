#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace condyle {

/// A lattice of values in space: Hounsfield units of a CT scan.
struct Volume {
  std::array<int, 3> size = {0, 0, 0};                   // along each axis of the lattice
  Eigen::Vector3d spacing_mm = Eigen::Vector3d::Ones();  // between neighbours along each axis
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();    // columns: their unit directions, LPS
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      // centre of the first value, mm, LPS
  std::vector<std::int16_t> values = {};                 // the first axis fastest

  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(i);
  }
  std::int16_t at(int i, int j, int k) const { return values[index(i, j, k)]; }
  /// Position of a value, or of a place between values, mm, LPS.
  Eigen::Vector3d position(double i, double j, double k) const {
    return origin + axes * spacing_mm.cwiseProduct(Eigen::Vector3d(i, j, k));
  }
};

}  // namespace condyle
