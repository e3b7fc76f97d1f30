#include "render/recording/strap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace condyle {

Eigen::Vector2d strap_side(int side) {
  const double angle = 2 * std::numbers::pi * side / strap_sides;
  return {std::cos(angle), std::sin(angle)};
}

float fibre_of(int side, double half_width_mm) {
  constexpr double bundle_mm = 2.4;
  const double bundles = std::max(2.0, std::round(2 * half_width_mm / bundle_mm));
  // Along the outline rather than the width: fibres would crowd at the edges.
  const double along = 1 - std::abs(2.0 * side / strap_sides - 1);
  return static_cast<float>(bundles * along);
}

void add_strap_triangles(FibreBody& body, int first_vertex, int rings, bool loop) {
  const auto at = [&](int ring, int side) {
    return first_vertex + ring % rings * strap_sides + side % strap_sides;
  };
  for (int ring = 0; ring < (loop ? rings : rings - 1); ++ring)
    for (int side = 0; side < strap_sides; ++side) {
      const int a = at(ring, side), b = at(ring, side + 1), c = at(ring + 1, side),
                d = at(ring + 1, side + 1);
      body.triangles.emplace_back(a, d, b);
      body.triangles.emplace_back(a, c, d);
    }
  if (loop) return;
  const int start = first_vertex + rings * strap_sides;
  for (int side = 0; side < strap_sides; ++side) {
    body.triangles.emplace_back(start, at(0, side), at(0, side + 1));
    body.triangles.emplace_back(start + 1, at(rings - 1, side + 1), at(rings - 1, side));
  }
}

}  // namespace condyle
