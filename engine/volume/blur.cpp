#include "engine/volume/blur.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/volume/lines.h"

namespace condyle {
namespace {

/// Weights at 0, 1, ... steps; the sum over both sides is 1.
std::vector<float> gauss_weights(double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
  std::vector<double> weights;
  double sum = 0;
  for (int i = 0; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += i == 0 ? weights.back() : 2 * weights.back();
  }
  std::vector<float> scaled;
  for (const double weight : weights) scaled.push_back(static_cast<float>(weight / sum));
  return scaled;
}

std::int16_t rounded(float value) {
  constexpr float low = std::numeric_limits<std::int16_t>::min(),
                  high = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::floor(std::clamp(value, low, high) + 0.5f));
}

}  // namespace

void blur(std::vector<std::int16_t>& values, const std::array<int, 3>& size, double sigma,
          int threads) {
  blur(values, size, {sigma, sigma, sigma}, threads);
}

void blur(std::vector<std::int16_t>& values, const std::array<int, 3>& size,
          const std::array<double, 3>& sigma, int threads) {
  assert(values.size() == lattice_count(size));
  for (int axis = 0; axis < 3; ++axis) {
    if (sigma[static_cast<std::size_t>(axis)] <= 0) continue;
    const std::vector<float> weights = gauss_weights(sigma[static_cast<std::size_t>(axis)]);
    const std::size_t reach = weights.size() - 1;
    const auto blur_line = [&](float* line, std::size_t n) {
      thread_local std::vector<float> padded;
      padded.resize(n + 2 * reach);
      std::fill_n(padded.begin(), reach, line[0]);
      std::copy_n(line, n, padded.begin() + static_cast<std::ptrdiff_t>(reach));
      std::fill_n(padded.end() - static_cast<std::ptrdiff_t>(reach), reach, line[n - 1]);
      for (std::size_t q = 0; q < n; ++q) {
        const float* at = padded.data() + q + reach;
        float sum = weights[0] * at[0];
        for (std::size_t r = 1; r <= reach; ++r)
          sum += weights[r] * (at[r] + at[-static_cast<std::ptrdiff_t>(r)]);
        line[q] = sum;
      }
    };
    change_lines(values, size, axis, threads, blur_line, rounded);
  }
}

}  // namespace condyle
