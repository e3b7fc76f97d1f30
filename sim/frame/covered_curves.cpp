#include "sim/frame/covered_curves.h"

#include <cmath>

namespace condyle {
namespace {

/// Whether one curve covers most of another with the same sample times.
bool hides(const std::vector<LabelPlacement::Point>& upper,
           const std::vector<LabelPlacement::Point>& lower) {
  constexpr double near = 1.5;
  if (upper.size() != lower.size()) return false;
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < upper.size(); ++i)
    hidden += std::hypot(upper[i].x - lower[i].x, upper[i].y - lower[i].y) < near;
  return 2 * hidden > upper.size();
}

}  // namespace

int curves_over(std::span<const std::vector<LabelPlacement::Point>> runs, std::size_t c) {
  constexpr int most = 2;
  int over = 0;
  for (std::size_t on = c + 1; on < runs.size() && over < most; ++on)
    over += hides(runs[on], runs[c]) ? 1 : 0;
  return over;
}

}  // namespace condyle
