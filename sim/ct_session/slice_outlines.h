#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/ct_session/slice_values.h"

namespace condyle {

/// A piece of an outline between two points, in values of the slice to the right and down from its
/// first.
using OutlinePiece = std::array<Eigen::Vector2f, 2>;

/// A slice after a blur of 0.6 values, as bone is searched in.
std::vector<float> smooth_values(const SliceValues& slice);

/// Where values cross a level, by marching squares, linear between neighbours.
std::vector<OutlinePiece> outlines(const std::vector<float>& values, int width, int height,
                                   double level);

/// The outlines of what the air around the head meets: those of air inside are left out.
std::vector<OutlinePiece> outer_outlines(std::vector<float> values, int width, int height,
                                         double level);

}  // namespace condyle
