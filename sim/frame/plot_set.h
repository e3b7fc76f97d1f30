#pragma once

#include <string>
#include <vector>

#include "sim/frame/plot.h"

namespace condyle {

/// Plots of one kind, side by side.
struct PlotSet {
  std::string name;  // on its tab
  std::vector<PlotPanel> panels;
  /// Time of each point of curves with this number of points. The current time is marked on them.
  std::vector<double> time_s = {};
};

}  // namespace condyle
