#pragma once

#include "sim/choice/ct_view.h"
#include "sim/ct_session/slice_values.h"

namespace condyle {

/// Levels at which outlines are drawn, HU.
struct SliceLevels {
  double bone = 0, skin = 0;
};

/// Draws the slice nearest to a point: grey values from -500 to 1500 HU, the outline of bone in
/// yellow and that of the skin in blue.
CtSliceView draw_slice(const Volume& volume, SliceSide side, const Eigen::Vector3d& point,
                       const SliceLevels& levels, int threads = 1);

}  // namespace condyle
