#include "sim/report/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/frame/plot_places.h"

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
  void widen(double wanted) {
    const double middle = 0.5 * (low + high);
    low = middle - 0.5 * wanted;
    high = middle + 0.5 * wanted;
  }
};

std::string label(double value, double step) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", std::abs(value) < step * 1e-6 ? 0.0 : value, decimals);
}

/// Corners of a band's area in the drawing; of a strip from one end of the axes to the other.
template <class X, class Y>
std::vector<WordPlaces::Point> corners_of(const PlotBand& band, const X& px, const Y& py,
                                          double low, double high) {
  std::vector<double> x = band.x, y = band.y;
  if (x.empty()) {
    const auto [least, most] = std::minmax_element(band.y.begin(), band.y.end());
    x = {low, high, high, low};
    y = {*least, *least, *most, *most};
  }
  std::vector<WordPlaces::Point> corners;
  for (std::size_t i = 0; i < x.size(); ++i) corners.push_back({px(x[i]), py(y[i])});
  return corners;
}

std::string band_svg(const std::vector<WordPlaces::Point>& corners) {
  std::string svg =
      "<polygon clip-path=\"url(#axes)\" fill=\"#cfe3d4\" fill-opacity=\"0.75\" "
      "stroke=\"#8fb79b\" points=\"";
  for (const auto& p : corners) svg += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
  return svg + "\"/>\n";
}

DrawnArea bounds_of(const std::vector<WordPlaces::Point>& points) {
  DrawnArea bounds{1e300, 1e300, -1e300, -1e300};
  for (const auto& p : points)
    bounds = {std::min(bounds.left, p.x), std::min(bounds.top, p.y), std::max(bounds.right, p.x),
              std::max(bounds.bottom, p.y)};
  return bounds;
}

/// Letters of sans-serif fonts are about so wide, as a share of their size; signs of two bytes
/// count twice.
double width_of(const std::string& words, double font_size) {
  return 0.6 * font_size * static_cast<double>(words.size());
}

std::vector<WordPlaces::Point> places_of(const Curve& curve, const auto& px, const auto& py) {
  std::vector<WordPlaces::Point> run;
  for (std::size_t i = 0; i < curve.x.size(); ++i) run.push_back({px(curve.x[i]), py(curve.y[i])});
  return run;
}

/// Whether one curve hides most of another that was measured at the same moments.
bool hides(const std::vector<WordPlaces::Point>& upper,
           const std::vector<WordPlaces::Point>& lower) {
  constexpr double near = 1.5;
  if (upper.size() != lower.size()) return false;
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < upper.size(); ++i)
    hidden += std::hypot(upper[i].x - lower[i].x, upper[i].y - lower[i].y) < near;
  return 2 * hidden > upper.size();
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  return safe;
}

std::string plot_svg(const std::vector<Curve>& curves, const PlotSettings& settings) {
  Range x, y;
  for (const auto& curve : curves)
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      x.include(curve.x[i]);
      y.include(std::min(curve.y[i], settings.y_most));
    }
  if (curves.empty() || x.low > x.high) x = y = {0, 1};
  for (const auto& level : settings.levels) y.include(level.y);
  for (const auto& band : settings.bands) {
    for (const double v : band.x) x.include(v);
    for (const double v : band.y) y.include(v);
  }
  const double width = left + axes_width + right + (settings.legend_beside ? legend_width : 0);
  const double inner_width = axes_width, inner_height = height - top - bottom;
  x.widen(std::max(x.size() * 1.06, 1e-3));
  y.widen(std::max(y.size() * 1.12, 1e-3));
  if (settings.legend && !settings.legend_beside) {
    // Room for the names above the curves.
    const auto named = std::count_if(curves.begin(), curves.end(),
                                     [](const Curve& curve) { return !curve.name.empty(); });
    y.high += y.size() * 18.0 * static_cast<double>(named) / inner_height;
  }
  if (settings.equal_scale) {
    const double scale = std::max(x.size() / inner_width, y.size() / inner_height);
    x.widen(scale * inner_width);
    y.widen(scale * inner_height);
  }
  const auto px = [&](double v) { return left + (v - x.low) / x.size() * inner_width; };
  const auto py = [&](double v) { return top + (y.high - v) / y.size() * inner_height; };

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" font-family=\"sans-serif\" font-size=\"13\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n"
      "<text x=\"{2}\" y=\"26\" font-size=\"16\" fill=\"#222\">{3}</text>\n",
      width, height, left, settings.title);
  svg += fmt::format(
      "<clipPath id=\"axes\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n",
      left, top, inner_width, inner_height);
  for (const auto& band : settings.bands) svg += band_svg(corners_of(band, px, py, x.low, x.high));
  constexpr int most_ticks = 7;
  const Ticks across = ticks(x.low, x.high, most_ticks), up = ticks(y.low, y.high, most_ticks);
  for (const double v : across.values)
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#e2e2e2\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\" fill=\"#444\">{4}</text>\n",
        px(v), top, height - bottom, height - bottom + 18, label(v, across.step));
  for (const double v : up.values)
    svg += fmt::format(
        "<line x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" stroke=\"#e2e2e2\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\" fill=\"#444\">{5}</text>\n",
        py(v), left, left + axes_width, left - 8, py(v) + 4, label(v, up.step));
  svg += fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>\n"
      "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\" fill=\"#222\">{}</text>\n"
      "<text transform=\"translate(18 {:.1f}) rotate(-90)\" text-anchor=\"middle\" "
      "fill=\"#222\">{}</text>\n",
      left, top, inner_width, inner_height, left + inner_width / 2, height - 14, settings.x_label,
      top + inner_height / 2, settings.y_label);
  const double legend_x = left + 12 + (settings.legend_beside ? axes_width : 0);
  double legend_y = top + 20;
  WordPlaces places({left, top, left + inner_width, height - bottom}, 1);
  const auto taken_by = [&](const std::string& words, double font_size) {
    places.add_words(
        {legend_x, legend_y - font_size, legend_x + 28 + width_of(words, font_size), legend_y + 4});
  };
  for (const auto& level : settings.levels) {
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#222\" "
        "stroke-dasharray=\"2 3\"/>",
        left, left + axes_width, py(level.y));
    places.add_curve({{left, py(level.y)}, {left + axes_width, py(level.y)}});
  }
  std::vector<std::vector<WordPlaces::Point>> runs;
  for (const auto& curve : curves) runs.push_back(places_of(curve, px, py));
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const auto& curve = curves[c];
    const auto& run = runs[c];
    // Wide enough to be seen on both sides of what lies on it.
    double stroke = 2;
    for (std::size_t on = c + 1; on < curves.size() && stroke < 8; ++on)
      if (hides(runs[on], run)) stroke += 3;
    const std::size_t number = curve.colour < 0 ? c : static_cast<std::size_t>(curve.colour);
    const char* colour = colours[number % colours.size()];
    const char* dashes = curve.dashed ? " stroke-dasharray=\"6 4\"" : "";
    svg += fmt::format(
        "<polyline clip-path=\"url(#axes)\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{} "
        "points=\"",
        colour, stroke, dashes);
    for (const auto& p : run) svg += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
    svg += "\"/>\n";
    places.add_curve(run);
    if (curve.name.empty() || !settings.legend) continue;
    taken_by(curve.name, 13);
    svg += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.0f}\" y2=\"{:.0f}\" stroke=\"{}\" "
        "stroke-width=\"{}\"{}/><text x=\"{}\" y=\"{:.0f}\" fill=\"#222\">{}</text>\n",
        legend_x, legend_x + 22, legend_y - 4, legend_y - 4, colour, stroke, dashes, legend_x + 28,
        legend_y, escaped(curve.name));
    legend_y += 18;
  }
  for (const auto& remark : settings.remarks) {
    taken_by(remark, 12);
    svg += fmt::format("<text x=\"{}\" y=\"{:.0f}\" fill=\"#444\" font-size=\"12\">{}</text>\n",
                       legend_x, legend_y + 8, escaped(remark));
    legend_y += 16;
  }
  // Names of bands and levels come last, where nothing else is.
  const auto write = [&](const std::string& words, const DrawnArea& near, double font_size,
                         const char* ink) {
    if (words.empty()) return;
    const auto at = places.take(width_of(words, font_size) + 8, font_size + 4, near);
    svg += fmt::format(
        "<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" fill=\"{}\">{}</text>\n",
        at.x + 4, at.y + font_size, font_size, ink, escaped(words));
  };
  std::vector<std::vector<WordPlaces::Point>> outlines;
  for (const auto& band : settings.bands) {
    outlines.push_back(corners_of(band, px, py, x.low, x.high));
    if (!band.x.empty()) places.add_outline(outlines.back());
  }
  for (std::size_t b = 0; b < outlines.size(); ++b) {
    DrawnArea near = bounds_of(outlines[b]);
    if (settings.bands[b].x.empty()) near.right = near.left;
    write(settings.bands[b].name, near, 11, "#3c6b4a");
  }
  for (const auto& level : settings.levels) {
    const double right_end = left + axes_width;
    write(level.name, {right_end, py(level.y) - 16, right_end, py(level.y)}, 12, "#222");
  }
  return svg + "</svg>\n";
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
