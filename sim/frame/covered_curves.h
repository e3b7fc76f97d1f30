#pragma once

#include <span>
#include <vector>

#include "sim/frame/label_placement.h"

namespace condyle {

/// Number of later curves that cover most of curve `c` on the page, at most 2: a curve must be
/// drawn wider by so many lines to show on both sides of them. Curves with other sample times cover
/// none.
int curves_over(std::span<const std::vector<LabelPlacement::Point>> runs, std::size_t c);

}  // namespace condyle
