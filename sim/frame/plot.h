#pragma once

#include <string>
#include <vector>

namespace condyle {

/// One curve of a plot.
struct Curve {
  std::string name;  // empty: not in the legend
  std::vector<double> x, y;
  int colour = -1;  // index in the palette; -1 = the curve's own index
  bool dashed = false;
};

/// A named horizontal line.
struct Level {
  std::string name;
  double y = 0;
};

/// A named area behind the curves: a published range.
struct PlotBand {
  std::string name;
  std::vector<double> x, y;  // corners; without x a strip between the lowest and highest y
};

/// Axes, background areas and remarks.
struct PlotSettings {
  std::string title, x_label, y_label;
  bool equal_scale = false;  // one millimetre has the same length on both axes
  std::vector<Level> levels = {};
  std::vector<std::string> remarks = {};  // under the legend
  bool legend_beside = false;             // right of the axes, where many curves leave no space
  double y_most = 1e300;                  // curves are cut off above
  std::vector<PlotBand> bands = {};
  bool legend = true;
  bool x_goes_back = false;  // x = -3 is labelled as 3 ago, in whole numbers
};

/// Curves and how to draw them: a plain value, independent of the renderer.
struct PlotPanel {
  std::vector<Curve> curves;
  PlotSettings settings;
};

}  // namespace condyle
