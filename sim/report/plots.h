#pragma once

#include <string>
#include <vector>

#include "sim/frame/frame_state.h"

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

/// A line plot as SVG text: axes with ticks and units, a legend, Okabe-Ito colours.
struct PlotSettings {
  std::string title, x_label, y_label;
  bool equal_scale = false;  // one millimetre is as long on both axes
  std::vector<Level> levels = {};
  std::vector<std::string> remarks = {};  // under the legend
  bool legend_beside = false;             // right of the axes, where many curves leave no room
  double y_most = 1e300;                  // curves are cut off above
};

/// Text for SVG and HTML.
std::string escaped(const std::string& text);

std::string plot_svg(const std::vector<Curve>& curves, const PlotSettings& settings);

/// What the plots of a recording need of each frame.
class MotionCurves {
 public:
  void add(const FrameState& frame);
  std::string opening_svg() const;   // opening and rotation over time
  std::string sagittal_svg() const;  // incisal and condylar paths seen from the left
  std::string frontal_svg() const;   // incisal path seen from the front

 private:
  std::vector<double> time_, opening_, rotation_, interincisal_;
  std::vector<Eigen::Vector3d> incisor_, left_, right_;
};

}  // namespace condyle
