#pragma once

#include <string>
#include <vector>

namespace condyle {

/// One curve of a plot.
struct Curve {
  std::string name;  // empty: not in the legend
  std::vector<double> x, y;
  int colour = -1;  // number in the row of colours; -1 = the curve's own number
  bool dashed = false;
};

/// A horizontal line with a name of its own.
struct Level {
  std::string name;
  double y = 0;
};

/// An area with a name behind the curves: what was published.
struct PlotBand {
  std::string name;
  std::vector<double> x, y;  // corners; without x a strip between the lowest and highest y
};

/// Axes, what stands behind the curves and what is said beside them.
struct PlotSettings {
  std::string title, x_label, y_label;
  bool equal_scale = false;  // one millimetre is as long on both axes
  std::vector<Level> levels = {};
  std::vector<std::string> remarks = {};  // under the legend
  bool legend_beside = false;             // right of the axes, where many curves leave no room
  double y_most = 1e300;                  // curves are cut off above
  std::vector<PlotBand> bands = {};
  bool legend = true;
  bool x_goes_back = false;  // what lies at -3 is told as 3 ago, in whole numbers
};

/// Curves and how to draw them: a plain value, for whoever draws.
struct PlotPanel {
  std::vector<Curve> curves;
  PlotSettings settings;
};

}  // namespace condyle
