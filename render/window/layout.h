#pragma once

#include "render/window/camera_control.h"

namespace condyle {

/// Where the panels stand, pixels: a bar on top, a column on each side, the timeline below, and the
/// 3-D view in what is left; plots, where they are wanted, below it. Without panels the view has
/// the whole window.
struct Layout {
  ViewRect top, left, right, bottom, view, plots;
};
Layout lay_out(double width, double height, double scale, bool with_panels,
               bool with_plots = false);

}  // namespace condyle
