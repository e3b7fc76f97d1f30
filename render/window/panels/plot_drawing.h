#pragma once

#include <optional>
#include <string>

#include "render/window/panels/widgets.h"
#include "sim/frame/plot_set.h"

namespace condyle {

/// Interpolated point of the curve at a time; none without times, or outside their range.
std::optional<Eigen::Vector2d> place_on(const Curve& curve, const std::vector<double>& time_s,
                                        double now_s);

/// Draws a panel into a rectangle of the screen: published ranges behind, the curves, the current
/// time on them, and the value under the mouse.
void draw_plot(Pen& pen, const PlotPanel& panel, const std::vector<double>& time_s, double now_s,
               const ViewRect& rect);

}  // namespace condyle
