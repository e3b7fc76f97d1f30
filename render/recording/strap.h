#pragma once

#include <Eigen/Core>
#include <vector>

#include "render/overlay/overlays.h"

namespace condyle {

/// Vertices around each ring of a strap.
constexpr int strap_sides = 20;

/// Place of a side on its ring, as fractions of half the width and half the thickness.
Eigen::Vector2d strap_side(int side);
/// Width (-1 to 1 is half) of a side as a fibre number: the same on both faces.
float fibre_of(int side, double half_width_mm);

/// Adds triangles of a strap whose rings are next in the body: ring after ring, and unless it is
/// a loop a point at each end after them.
void add_strap_triangles(FibreBody& body, int first_vertex, int rings, bool loop);

}  // namespace condyle
