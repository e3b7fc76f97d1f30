#pragma once

#include <string>
#include <vector>

#include "sim/frame/plot.h"

namespace condyle {

/// Plots of one kind, one beside the other.
struct PlotSet {
  std::string name;  // on its tab
  std::vector<PlotPanel> panels;
  /// Of curves with as many points: when each was. What the clock says is marked on them.
  std::vector<double> time_s = {};
};

}  // namespace condyle
