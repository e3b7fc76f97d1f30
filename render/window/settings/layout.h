#pragma once

#include "render/window/input/camera_control.h"

namespace condyle {

/// Positions of the panels, pixels: a bar on top, a column on each side, the timeline below, and
/// the 3-D view in the remaining space, with a tool, while one is in use, at its left and plots, if
/// shown, below it. Without panels the view and a tool have the whole window.
struct Layout {
  ViewRect top, left, right, bottom, view, plots, tool;
};

/// Sizes of the resizable panels, pixels at scale 1. The columns are never narrower than their
/// defaults: their texts need that width.
struct PanelSizes {
  double left = 244, right = 286;
  double plots = 0;  // height; 0: a fraction of the window's
  bool operator==(const PanelSizes&) const = default;
};

/// Optional panels beside or below the view.
struct Beside {
  bool plots = false, tool = false;
};

Layout lay_out(double width, double height, double scale, bool with_panels,
               const Beside& beside = {}, const PanelSizes& sizes = {});

}  // namespace condyle
