#pragma once

#include "render/window/camera_control.h"

namespace condyle {

/// Where the panels stand, pixels: a bar on top, a column on each side, the timeline below, and the
/// 3-D view in what is left; plots, where they are wanted, below it. Without panels the view has
/// the whole window.
struct Layout {
  ViewRect top, left, right, bottom, view, plots;
};

/// Of what can be drawn wider or higher, pixels at scale 1. The columns are never narrower than at
/// first: their words need that room.
struct PanelSizes {
  double left = 244, right = 286;
  double plots = 0;  // height; 0: a share of the window's
  bool operator==(const PanelSizes&) const = default;
};

Layout lay_out(double width, double height, double scale, bool with_panels, bool with_plots = false,
               const PanelSizes& sizes = {});

}  // namespace condyle
