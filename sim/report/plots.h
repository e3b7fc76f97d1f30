#pragma once

#include <string>
#include <vector>

#include "sim/frame/plot.h"

namespace condyle {

/// A line plot as SVG text: axes with ticks and units, a legend, Okabe-Ito colours.
std::string plot_svg(const std::vector<Curve>& curves, const PlotSettings& settings);

/// Panels beside each other as one SVG.
std::string panels_svg(const std::vector<PlotPanel>& panels);

}  // namespace condyle
