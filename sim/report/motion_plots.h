#pragma once

#include <string>
#include <vector>

#include "sim/report/motion_series.h"
#include "sim/report/plots.h"

namespace condyle {

/// One figure of a motion: panels side by side. Plain values, drawn as SVG or in the window.
struct MotionPlot {
  std::string name;  // stem of the file name: "posselt"
  std::vector<PlotPanel> panels;
};

/// The clinical plots of a motion with published reference bands: Posselt's diagram of the incisal
/// point, axiography of both condyles (sagittal, horizontal and frontal), opening and excursions
/// over time, rotation and speed over time; for a muscle-driven motion also activation and force of
/// the strongest muscles of each side over time.
std::vector<MotionPlot> motion_plots(const MotionSeries& series);

}  // namespace condyle
