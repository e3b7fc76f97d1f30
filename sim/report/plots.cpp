#include "sim/report/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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

/// Distance between ticks: 1, 2 or 5 times a power of ten, about six on an axis.
double tick_step(double span) {
  const double raw = span / 6, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10 * power;
}

std::string label(double value, double step) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", std::abs(value) < step * 1e-6 ? 0.0 : value, decimals);
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
  const double width = left + axes_width + right + (settings.legend_beside ? legend_width : 0);
  const double inner_width = axes_width, inner_height = height - top - bottom;
  x.widen(std::max(x.size() * 1.06, 1e-3));
  y.widen(std::max(y.size() * 1.12, 1e-3));
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
  const double step_x = tick_step(x.size()), step_y = tick_step(y.size());
  for (double v = std::ceil(x.low / step_x) * step_x; v <= x.high; v += step_x)
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#e2e2e2\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\" fill=\"#444\">{4}</text>\n",
        px(v), top, height - bottom, height - bottom + 18, label(v, step_x));
  for (double v = std::ceil(y.low / step_y) * step_y; v <= y.high; v += step_y)
    svg += fmt::format(
        "<line x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" stroke=\"#e2e2e2\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\" fill=\"#444\">{5}</text>\n",
        py(v), left, left + axes_width, left - 8, py(v) + 4, label(v, step_y));
  svg += fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>\n"
      "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\" fill=\"#222\">{}</text>\n"
      "<text transform=\"translate(18 {:.1f}) rotate(-90)\" text-anchor=\"middle\" "
      "fill=\"#222\">{}</text>\n",
      left, top, inner_width, inner_height, left + inner_width / 2, height - 14, settings.x_label,
      top + inner_height / 2, settings.y_label);
  const double legend_x = left + 12 + (settings.legend_beside ? axes_width : 0);
  double legend_y = top + 20;
  svg += fmt::format(
      "<clipPath id=\"axes\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n",
      left, top, inner_width, inner_height);
  for (const auto& level : settings.levels) {
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#222\" "
        "stroke-dasharray=\"2 3\"/><text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\" "
        "fill=\"#222\" font-size=\"12\">{5}</text>\n",
        left, left + axes_width, py(level.y), left + axes_width - 6, py(level.y) - 4,
        escaped(level.name));
  }
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const auto& curve = curves[c];
    const std::size_t number = curve.colour < 0 ? c : static_cast<std::size_t>(curve.colour);
    const char* colour = colours[number % colours.size()];
    svg += fmt::format(
        "<polyline clip-path=\"url(#axes)\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{} "
        "points=\"",
        colour, curve.dashed ? " stroke-dasharray=\"6 4\"" : "");
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      svg += fmt::format("{:.2f},{:.2f} ", px(curve.x[i]), py(curve.y[i]));
    svg += "\"/>\n";
    if (curve.name.empty()) continue;
    svg += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.0f}\" y2=\"{:.0f}\" stroke=\"{}\" "
        "stroke-width=\"2\"/><text x=\"{}\" y=\"{:.0f}\" fill=\"#222\">{}</text>\n",
        legend_x, legend_x + 22, legend_y - 4, legend_y - 4, colour, legend_x + 28, legend_y,
        escaped(curve.name));
    legend_y += 18;
  }
  for (const auto& remark : settings.remarks) {
    svg += fmt::format("<text x=\"{}\" y=\"{:.0f}\" fill=\"#444\" font-size=\"12\">{}</text>\n",
                       legend_x, legend_y + 8, escaped(remark));
    legend_y += 16;
  }
  return svg + "</svg>\n";
}

void MotionCurves::add(const FrameState& frame) {
  time_.push_back(frame.time_s);
  opening_.push_back(frame.measures.opening_mm);
  rotation_.push_back(frame.measures.rotation_deg);
  interincisal_.push_back(frame.measures.interincisal_mm);
  incisor_.push_back(frame.measures.incisor);
  left_.push_back(frame.measures.left_condyle);
  right_.push_back(frame.measures.right_condyle);
}

std::string MotionCurves::opening_svg() const {
  return plot_svg({{"opening, mm", time_, opening_},
                   {"between incisors, mm", time_, interincisal_},
                   {"rotation, degrees", time_, rotation_}},
                  {.title = "Opening over time", .x_label = "time, s", .y_label = "mm or degrees"});
}

namespace {

Curve path(const char* name, const std::vector<Eigen::Vector3d>& points, int across) {
  Curve curve{name, {}, {}};
  for (const auto& p : points) {
    curve.x.push_back(p[across]);
    curve.y.push_back(p.z());
  }
  return curve;
}

}  // namespace

std::string MotionCurves::sagittal_svg() const {
  return plot_svg({path("lower incisal point", incisor_, 1), path("left condyle", left_, 1),
                   path("right condyle", right_, 1)},
                  {.title = "Paths seen from the patient's left side",
                   .x_label = "anterior  -  y, mm  -  posterior",
                   .y_label = "inferior  -  z, mm  -  superior",
                   .equal_scale = true});
}

std::string MotionCurves::frontal_svg() const {
  return plot_svg({path("lower incisal point", incisor_, 0)},
                  {.title = "Incisal path seen from the front",
                   .x_label = "patient's right  -  x, mm  -  left",
                   .y_label = "inferior  -  z, mm  -  superior",
                   .equal_scale = true});
}

}  // namespace condyle
