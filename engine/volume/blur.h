#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace condyle {

/// Blurs a lattice by a Gaussian of `sigma` in steps along each axis; the values at the border
/// continue beyond it. Rounded to whole numbers after each axis. Bit-identical for any number of
/// threads.
void blur(std::vector<std::int16_t>& values, const std::array<int, 3>& size, double sigma,
          int threads);

/// The same with a sigma for each axis; 0 leaves an axis unchanged.
void blur(std::vector<std::int16_t>& values, const std::array<int, 3>& size,
          const std::array<double, 3>& sigma, int threads);

}  // namespace condyle
