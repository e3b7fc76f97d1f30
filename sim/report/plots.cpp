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

/// A band's area, its name at its upper left corner.
template <class X, class Y>
std::string band_svg(const PlotBand& band, const X& px, const Y& py, double low, double high) {
  std::vector<double> x = band.x, y = band.y;
  if (x.empty()) {
    const auto [least, most] = std::minmax_element(band.y.begin(), band.y.end());
    x = {low, high, high, low};
    y = {*least, *least, *most, *most};
  }
  std::string svg =
      "<polygon clip-path=\"url(#axes)\" fill=\"#cfe3d4\" fill-opacity=\"0.75\" "
      "stroke=\"#8fb79b\" points=\"";
  for (std::size_t i = 0; i < x.size(); ++i)
    svg += fmt::format("{:.2f},{:.2f} ", px(x[i]), py(y[i]));
  const double at_x = px(*std::min_element(x.begin(), x.end()));
  const double at_y = py(*std::max_element(y.begin(), y.end()));
  return svg +
         fmt::format(
             "\"/><text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\" fill=\"#3c6b4a\">{}</text>\n",
             at_x + 4, at_y + 12, escaped(band.name));
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
  for (const auto& band : settings.bands) svg += band_svg(band, px, py, x.low, x.high);
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
    const char* dashes = curve.dashed ? " stroke-dasharray=\"6 4\"" : "";
    svg += fmt::format(
        "<polyline clip-path=\"url(#axes)\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{} "
        "points=\"",
        colour, dashes);
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      svg += fmt::format("{:.2f},{:.2f} ", px(curve.x[i]), py(curve.y[i]));
    svg += "\"/>\n";
    if (curve.name.empty() || !settings.legend) continue;
    svg += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.0f}\" y2=\"{:.0f}\" stroke=\"{}\" "
        "stroke-width=\"2\"{}/><text x=\"{}\" y=\"{:.0f}\" fill=\"#222\">{}</text>\n",
        legend_x, legend_x + 22, legend_y - 4, legend_y - 4, colour, dashes, legend_x + 28,
        legend_y, escaped(curve.name));
    legend_y += 18;
  }
  for (const auto& remark : settings.remarks) {
    svg += fmt::format("<text x=\"{}\" y=\"{:.0f}\" fill=\"#444\" font-size=\"12\">{}</text>\n",
                       legend_x, legend_y + 8, escaped(remark));
    legend_y += 16;
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
