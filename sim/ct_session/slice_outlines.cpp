#include "sim/ct_session/slice_outlines.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace condyle {
namespace {

std::size_t cell_count(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

/// Pixels below the level that are connected to the border of the slice.
std::vector<std::uint8_t> outer_air(const std::vector<float>& values, int width, int height,
                                    double level) {
  std::vector<std::uint8_t> air(values.size(), 0);
  std::vector<int> open;
  const auto visit = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    const int at = y * width + x;
    const auto i = static_cast<std::size_t>(at);
    if (air[i] || values[i] >= level) return;
    air[i] = 1;
    open.push_back(at);
  };
  for (int x = 0; x < width; ++x) visit(x, 0), visit(x, height - 1);
  for (int y = 0; y < height; ++y) visit(0, y), visit(width - 1, y);
  while (!open.empty()) {
    const int at = open.back(), x = at % width, y = at / width;
    open.pop_back();
    visit(x - 1, y), visit(x + 1, y), visit(x, y - 1), visit(x, y + 1);
  }
  return air;
}

}  // namespace

std::vector<float> smooth_values(const SliceValues& slice) {
  const int width = slice.width, height = slice.height;
  constexpr float beside = 0.1664f, middle = 1 - 2 * beside;  // of a Gaussian of 0.6
  std::vector<float> rows(cell_count(width, height)), both(rows.size());
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      rows[at(x, y)] = middle * static_cast<float>(slice.values[at(x, y)]) +
                       beside * static_cast<float>(slice.values[at(std::max(0, x - 1), y)] +
                                                   slice.values[at(std::min(width - 1, x + 1), y)]);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      both[at(x, y)] =
          middle * rows[at(x, y)] +
          beside * (rows[at(x, std::max(0, y - 1))] + rows[at(x, std::min(height - 1, y + 1))]);
  return both;
}

std::vector<OutlinePiece> outlines(const std::vector<float>& values, int width, int height,
                                   double level) {
  std::vector<OutlinePiece> pieces;
  const auto value = [&](int x, int y) {
    return static_cast<double>(
        values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x)]);
  };
  for (int y = 0; y + 1 < height; ++y)
    for (int x = 0; x + 1 < width; ++x) {
      // Corners and edges in order around the cell.
      const std::array<double, 4> corner = {value(x, y), value(x + 1, y), value(x + 1, y + 1),
                                            value(x, y + 1)};
      static constexpr std::array<std::array<int, 2>, 4> place = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
      std::array<Eigen::Vector2f, 4> crossing;
      int crossings = 0;
      for (std::size_t e = 0; e < 4; ++e) {
        const double a = corner[e], b = corner[(e + 1) % 4];
        if ((a >= level) == (b >= level)) continue;
        const auto t = static_cast<float>((level - a) / (b - a));
        const auto& from = place[e];
        const auto& to = place[(e + 1) % 4];
        crossing[static_cast<std::size_t>(crossings++)] = {
            static_cast<float>(x + from[0]) + t * static_cast<float>(to[0] - from[0]),
            static_cast<float>(y + from[1]) + t * static_cast<float>(to[1] - from[1])};
      }
      if (crossings == 2) pieces.push_back({crossing[0], crossing[1]});
      if (crossings == 4) {  // the middle decides which corners are connected
        const bool middle = corner[0] + corner[1] + corner[2] + corner[3] >= 4 * level;
        const bool first = corner[0] >= level;
        if (middle == first) {
          pieces.push_back({crossing[0], crossing[1]});
          pieces.push_back({crossing[2], crossing[3]});
        } else {
          pieces.push_back({crossing[0], crossing[3]});
          pieces.push_back({crossing[1], crossing[2]});
        }
      }
    }
  return pieces;
}

std::vector<OutlinePiece> outer_outlines(std::vector<float> values, int width, int height,
                                         double level) {
  const auto air = outer_air(values, width, height, level);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!air[i] && values[i] < level) values[i] = static_cast<float>(level) + 1;
  return outlines(values, width, height, level);
}

}  // namespace condyle
