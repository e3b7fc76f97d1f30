#include "sim/report/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/html_text.h"
#include "sim/frame/covered_curves.h"
#include "sim/frame/label_placement.h"

namespace condyle {
namespace {

constexpr std::array<const char*, 6> colours = {"#0072B2", "#D55E00", "#009E73",
                                                "#CC79A7", "#E69F00", "#56B4E9"};
constexpr double height = 480, left = 70, right = 20, top = 44, bottom = 56;
constexpr double axes_width = 550, legend_width = 250;

struct Range {
  double low = 1e300, high = -1e300;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double size() const { return high - low; }
  void widen(double new_size) {
    const double middle = 0.5 * (low + high);
    low = middle - 0.5 * new_size;
    high = middle + 0.5 * new_size;
  }
};

std::string label(double value, double step) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", std::abs(value) < step * 1e-6 ? 0.0 : value, decimals);
}

/// Corners of a band in the drawing. A band without x extends over the whole width of the axes.
template <class X, class Y>
std::vector<LabelPlacement::Point> corners_of(const PlotBand& band, const X& px, const Y& py,
                                              double low, double high) {
  std::vector<double> x = band.x, y = band.y;
  if (x.empty()) {
    const auto [low_y, high_y] = std::minmax_element(band.y.begin(), band.y.end());
    x = {low, high, high, low};
    y = {*low_y, *low_y, *high_y, *high_y};
  }
  std::vector<LabelPlacement::Point> corners;
  for (std::size_t i = 0; i < x.size(); ++i) corners.push_back({px(x[i]), py(y[i])});
  return corners;
}

std::string band_svg(const std::vector<LabelPlacement::Point>& corners) {
  std::string svg =
      "<polygon clip-path=\"url(#axes)\" fill=\"#cfe3d4\" fill-opacity=\"0.75\" "
      "stroke=\"#8fb79b\" points=\"";
  for (const auto& p : corners) svg += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
  return svg + "\"/>\n";
}

DrawnArea bounds_of(const std::vector<LabelPlacement::Point>& points) {
  DrawnArea bounds{1e300, 1e300, -1e300, -1e300};
  for (const auto& p : points)
    bounds = {std::min(bounds.left, p.x), std::min(bounds.top, p.y), std::max(bounds.right, p.x),
              std::max(bounds.bottom, p.y)};
  return bounds;
}

/// Estimated width of a text in a sans-serif font; characters of two bytes count twice.
double width_of(const std::string& text, double font_size) {
  return 0.6 * font_size * static_cast<double>(text.size());
}

std::vector<LabelPlacement::Point> places_of(const Curve& curve, const auto& px, const auto& py) {
  std::vector<LabelPlacement::Point> run;
  for (std::size_t i = 0; i < curve.x.size(); ++i) run.push_back({px(curve.x[i]), py(curve.y[i])});
  return run;
}

}  // namespace

namespace {

/// Draws one plot as SVG.
class PlotWriter {
 public:
  PlotWriter(const std::vector<Curve>& curves, const PlotSettings& settings)
      : curves_(curves),
        settings_(settings),
        places_({left, top, left + inner_width, height - bottom}, 1),
        legend_x_(left + 12 + (settings.legend_beside ? axes_width : 0)) {
    find_ranges();
  }

  std::string write() {
    frame_and_grid();
    for (const auto& level : settings_.levels) level_line(level);
    for (const auto& curve : curves_) runs_.push_back(places_of(curve, px_, py_));
    for (std::size_t c = 0; c < curves_.size(); ++c) draw(c);
    for (const auto& remark : settings_.remarks) {
      reserve_legend(remark, 12);
      svg_ += fmt::format("<text x=\"{}\" y=\"{:.0f}\" fill=\"#444\" font-size=\"12\">{}</text>\n",
                          legend_x_, legend_y_ + 8, escaped(remark));
      legend_y_ += 16;
    }
    names();
    return std::move(svg_) + "</svg>\n";
  }

 private:
  static constexpr double inner_width = axes_width, inner_height = height - top - bottom;

  void find_ranges() {
    for (const auto& curve : curves_)
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        x_.include(curve.x[i]);
        y_.include(std::min(curve.y[i], settings_.y_most));
      }
    if (curves_.empty() || x_.low > x_.high) x_ = y_ = {0, 1};
    for (const auto& level : settings_.levels) y_.include(level.y);
    for (const auto& band : settings_.bands) {
      for (const double v : band.x) x_.include(v);
      for (const double v : band.y) y_.include(v);
    }
    x_.widen(std::max(x_.size() * 1.06, 1e-3));
    y_.widen(std::max(y_.size() * 1.12, 1e-3));
    if (settings_.legend && !settings_.legend_beside) {
      // Space for the legend above the curves.
      const auto named = std::count_if(curves_.begin(), curves_.end(),
                                       [](const Curve& curve) { return !curve.name.empty(); });
      y_.high += y_.size() * 18.0 * static_cast<double>(named) / inner_height;
    }
    if (settings_.equal_scale) {
      const double scale = std::max(x_.size() / inner_width, y_.size() / inner_height);
      x_.widen(scale * inner_width);
      y_.widen(scale * inner_height);
    }
  }

  void frame_and_grid() {
    const double width = left + axes_width + right + (settings_.legend_beside ? legend_width : 0);
    svg_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
        "height=\"{1}\" font-family=\"sans-serif\" font-size=\"13\">\n"
        "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n"
        "<text x=\"{2}\" y=\"26\" font-size=\"16\" fill=\"#222\">{3}</text>\n",
        width, height, left, settings_.title);
    svg_ += fmt::format(
        "<clipPath id=\"axes\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n",
        left, top, inner_width, inner_height);
    for (const auto& band : settings_.bands)
      svg_ += band_svg(corners_of(band, px_, py_, x_.low, x_.high));
    constexpr int max_ticks = 7;
    const Ticks across = ticks(x_.low, x_.high, max_ticks), up = ticks(y_.low, y_.high, max_ticks);
    for (const double v : across.values)
      svg_ += fmt::format(
          "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#e2e2e2\"/>"
          "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\" fill=\"#444\">{4}</text>\n",
          px_(v), top, height - bottom, height - bottom + 18, label(v, across.step));
    for (const double v : up.values)
      svg_ += fmt::format(
          "<line x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" stroke=\"#e2e2e2\"/>"
          "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\" fill=\"#444\">{5}</text>\n",
          py_(v), left, left + axes_width, left - 8, py_(v) + 4, label(v, up.step));
    svg_ += fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>\n"
        "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\" fill=\"#222\">{}</text>\n"
        "<text transform=\"translate(18 {:.1f}) rotate(-90)\" text-anchor=\"middle\" "
        "fill=\"#222\">{}</text>\n",
        left, top, inner_width, inner_height, left + inner_width / 2, height - 14,
        settings_.x_label, top + inner_height / 2, settings_.y_label);
  }

  void level_line(const Level& level) {
    svg_ += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#222\" "
        "stroke-dasharray=\"2 3\"/>",
        left, left + axes_width, py_(level.y));
    places_.add_curve({{left, py_(level.y)}, {left + axes_width, py_(level.y)}});
  }

  /// Keeps the names of bands and levels away from one line of the legend.
  void reserve_legend(const std::string& text, double font_size) {
    places_.add_words({legend_x_, legend_y_ - font_size, legend_x_ + 28 + width_of(text, font_size),
                       legend_y_ + 4});
  }

  /// One curve and its entry in the legend.
  void draw(std::size_t c) {
    const auto& curve = curves_[c];
    const auto& run = runs_[c];
    // Wide enough to show on both sides of a curve drawn over it.
    const double stroke = 2 + 3 * curves_over(runs_, c);
    const std::size_t number = curve.colour < 0 ? c : static_cast<std::size_t>(curve.colour);
    const char* colour = colours[number % colours.size()];
    const char* dashes = curve.dashed ? " stroke-dasharray=\"6 4\"" : "";
    svg_ += fmt::format(
        "<polyline clip-path=\"url(#axes)\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{} "
        "points=\"",
        colour, stroke, dashes);
    for (const auto& p : run) svg_ += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
    svg_ += "\"/>\n";
    places_.add_curve(run);
    if (curve.name.empty() || !settings_.legend) return;
    reserve_legend(curve.name, 13);
    svg_ += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.0f}\" y2=\"{:.0f}\" stroke=\"{}\" "
        "stroke-width=\"{}\"{}/><text x=\"{}\" y=\"{:.0f}\" fill=\"#222\">{}</text>\n",
        legend_x_, legend_x_ + 22, legend_y_ - 4, legend_y_ - 4, colour, stroke, dashes,
        legend_x_ + 28, legend_y_, escaped(curve.name));
    legend_y_ += 18;
  }

  /// Names of bands and levels, placed last in the free space.
  void names() {
    std::vector<std::vector<LabelPlacement::Point>> outlines;
    for (const auto& band : settings_.bands) {
      outlines.push_back(corners_of(band, px_, py_, x_.low, x_.high));
      if (!band.x.empty()) places_.add_outline(outlines.back());
    }
    for (std::size_t b = 0; b < outlines.size(); ++b) {
      DrawnArea near = bounds_of(outlines[b]);
      if (settings_.bands[b].x.empty()) near.right = near.left;
      name_near(settings_.bands[b].name, near, 11, "#3c6b4a");
    }
    for (const auto& level : settings_.levels) {
      const double right_end = left + axes_width;
      name_near(level.name, {right_end, py_(level.y) - 16, right_end, py_(level.y)}, 12, "#222");
    }
  }

  void name_near(const std::string& text, const DrawnArea& near, double font_size,
                 const char* colour) {
    if (text.empty()) return;
    const auto at = places_.take(width_of(text, font_size) + 8, font_size + 4, near);
    svg_ += fmt::format(
        "<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" fill=\"{}\">{}</text>\n",
        at.x + 4, at.y + font_size, font_size, colour, escaped(text));
  }

  /// From a value to a coordinate of the drawing.
  struct Scale {
    const Range& range;
    double start, size;
    bool downward;
    double operator()(double v) const {
      return downward ? start + (range.high - v) / range.size() * size
                      : start + (v - range.low) / range.size() * size;
    }
  };

  const std::vector<Curve>& curves_;
  const PlotSettings& settings_;
  Range x_, y_;
  const Scale px_{x_, left, inner_width, false}, py_{y_, top, inner_height, true};
  LabelPlacement places_;
  std::vector<std::vector<LabelPlacement::Point>> runs_;
  double legend_x_, legend_y_ = top + 20;
  std::string svg_;
};

}  // namespace

std::string plot_svg(const std::vector<Curve>& curves, const PlotSettings& settings) {
  return PlotWriter(curves, settings).write();
}

std::string panels_svg(const std::vector<PlotPanel>& panels) {
  constexpr double panel_width = left + axes_width + right;
  double across = 0;
  std::string inner;
  for (const auto& panel : panels) {
    std::string one = plot_svg(panel.curves, panel.settings);
    one.insert(5, fmt::format("x=\"{}\" y=\"0\" ", across));  // after "<svg "
    inner += one;
    across += panel_width + (panel.settings.legend_beside ? legend_width : 0);
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\">\n{2}</svg>\n",
      across, height, inner);
}

}  // namespace condyle
