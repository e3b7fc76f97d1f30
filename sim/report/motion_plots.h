#pragma once

#include <string>
#include <vector>

#include "sim/report/motion_series.h"
#include "sim/report/plots.h"

namespace condyle {

/// One picture of a motion: panels beside each other. Values, to be drawn as SVG or in a window.
struct MotionPlot {
  std::string name;  // of the file: "posselt"
  std::vector<PlotPanel> panels;
};

/// What clinicians look at, with the published bands behind: Posselt's diagram of the incisal
/// point, axiography of both condyles (sagittal, horizontal, frontal each), opening and excursions
/// over time, rotation and speed over time; of a motion that muscles drive, the activations and
/// forces of the strongest of each side over time.
std::vector<MotionPlot> motion_plots(const MotionSeries& series);

}  // namespace condyle
