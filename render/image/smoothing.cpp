#include "render/image/smoothing.h"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

namespace condyle {
namespace {

// Brightness is an integer, summed over four pixels.
constexpr int red = 77, green = 150, blue = 29;
constexpr int white = 4 * 255 * (red + green + blue);
constexpr int min_contrast = static_cast<int>(0.03 * white);

struct Pixels {
  const std::uint8_t* rgba;
  int width, height;

  const std::uint8_t* at(int x, int y) const {
    const auto column = static_cast<std::size_t>(std::clamp(x, 0, width - 1));
    const auto row = static_cast<std::size_t>(std::clamp(y, 0, height - 1));
    return rgba + 4 * (row * static_cast<std::size_t>(width) + column);
  }
  Eigen::Array4f color(int x, int y) const {
    const std::uint8_t* p = at(x, y);
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]),
            static_cast<float>(p[3])};
  }
  /// Offset from the centre of a pixel, between centres. The position of the picture does not
  /// affect rounding.
  Eigen::Array4f between(int x, int y, float right, float up) const {
    const float left = std::floor(right), low = std::floor(up), s = right - left, t = up - low;
    const int i = x + static_cast<int>(left), j = y + static_cast<int>(low);
    return (1 - t) * ((1 - s) * color(i, j) + s * color(i + 1, j)) +
           t * ((1 - s) * color(i, j + 1) + s * color(i + 1, j + 1));
  }
  /// Brightness of a row's pixels, beginning at `x`.
  void brightness(int x, int y, std::vector<int>& row) const {
    const int count = static_cast<int>(row.size());
    const int first = std::clamp(-x, 0, count), end = std::clamp(width - x, first, count);
    const auto of = [](const std::uint8_t* p) { return red * p[0] + green * p[1] + blue * p[2]; };
    const std::uint8_t* p = at(x + first, y);
    int* to = row.data();
    for (int i = first; i < end; ++i) to[i] = of(p + 4 * (i - first));
    for (int i = 0; i < first; ++i) to[i] = of(at(x + i, y));
    for (int i = end; i < count; ++i) to[i] = of(at(x + i, y));
  }
};

/// Brightness at the four corners of a pixel and at its centre.
struct Around {
  int sw, se, nw, ne, own;
  int low() const { return std::min({own, sw, se, nw, ne}); }
  int high() const { return std::max({own, sw, se, nw, ne}); }
};

/// Short form of Lottes' FXAA: where brightness changes, blur along the edge, and keep the longer
/// blur only if it stays between the neighbours.
Eigen::Array4f blurred(const Pixels& pixels, int x, int y, const Around& a) {
  const auto fraction = [](int sum) { return static_cast<float>(sum) / white; };
  Eigen::Array2f edge(fraction(a.sw + a.se - a.nw - a.ne), fraction(a.nw + a.sw - a.ne - a.se));
  const float shorten =
      1 / (edge.abs().minCoeff() + std::max(0.03f * fraction(a.nw + a.ne + a.sw + a.se), 0.008f));
  edge = (edge * shorten).max(-6).min(6);
  const auto at = [&](float offset) {
    return pixels.between(x, y, offset * edge.x(), offset * edge.y());
  };
  const Eigen::Array4f near = 0.5f * (at(-1.f / 6) + at(1.f / 6));
  const Eigen::Array4f far = 0.5f * near + 0.25f * (at(-0.5f) + at(0.5f));
  const float f = 4 * (red * far[0] + green * far[1] + blue * far[2]);
  return f < static_cast<float>(a.low()) || f > static_cast<float>(a.high()) ? near : far;
}

}  // namespace

void smooth_edges(std::span<const std::uint8_t> rgba, int width, int height, const DrawnBox& within,
                  std::vector<std::uint8_t>& smoothed) {
  assert(rgba.size() == std::size_t{4} * width * height);
  const Pixels pixels{rgba.data(), width, height};
  const auto columns = static_cast<std::size_t>(within.width());
  smoothed.resize(4 * columns * static_cast<std::size_t>(within.height()));
  // Rows of pixels with a margin of one on each side, and of the corners below and above them.
  std::vector<int> under(columns + 2), row(columns + 2), over(columns + 2);
  std::vector<int> below(columns + 1), above(columns + 1);
  std::vector<std::uint8_t> edge(columns);
  const auto corners = [&](const std::vector<int>& a, const std::vector<int>& b,
                           std::vector<int>& sums) {
    for (std::size_t i = 0; i <= columns; ++i) sums[i] = a[i] + a[i + 1] + b[i] + b[i + 1];
  };
  pixels.brightness(within.x0 - 1, within.y0 - 1, under);
  pixels.brightness(within.x0 - 1, within.y0, row);
  corners(under, row, below);
  for (int y = within.y0; y < within.y1; ++y) {
    pixels.brightness(within.x0 - 1, y + 1, over);
    corners(row, over, above);
    std::uint8_t* out = &smoothed[4 * columns * static_cast<std::size_t>(y - within.y0)];
    std::memcpy(out, pixels.at(within.x0, y), 4 * columns);
    const auto around = [&](std::size_t i) {
      return Around{below[i], below[i + 1], above[i], above[i + 1], 4 * row[i + 1]};
    };
    for (std::size_t i = 0; i < columns; ++i) {
      const Around a = around(i);
      const int high = a.high(), contrast = high - a.low();
      edge[i] = contrast >= min_contrast && 10 * contrast >= high;
    }
    for (std::size_t i = 0; i < columns; ++i) {
      if (!edge[i]) continue;
      const Around a = around(i);
      const Eigen::Array4f color = blurred(pixels, within.x0 + static_cast<int>(i), y, a);
      for (std::size_t k = 0; k < 4; ++k)
        out[4 * i + k] = static_cast<std::uint8_t>(color[static_cast<int>(k)] + 0.5f);
    }
    std::swap(row, over);
    std::swap(below, above);
  }
}

}  // namespace condyle
