#pragma once

#include <optional>
#include <string>

#include "render/window/panels/widgets.h"
#include "sim/frame/plot_set.h"

namespace condyle {

/// Where the curve was at a time, between its samples; none when it has no times or lies elsewhere.
std::optional<Eigen::Vector2d> place_on(const Curve& curve, const std::vector<double>& time_s,
                                        double now_s);

/// Draws a panel into a rectangle of the screen: what was published behind, the curves, the place
/// of the clock on them, and the value under the mouse.
void draw_plot(Pen& pen, const PlotPanel& panel, const std::vector<double>& time_s, double now_s,
               const ViewRect& rect);

}  // namespace condyle
