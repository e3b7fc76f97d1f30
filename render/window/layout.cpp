#include "render/window/layout.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

// What the picture keeps however wide the columns and however high the plots are drawn, at scale 1.
constexpr double least_view_width = 320, least_view_height = 160, least_plots_height = 150;

/// Two columns that leave the picture its room: the right one gives way first.
std::pair<double, double> column_widths(const PanelSizes& sizes, double room) {
  const PanelSizes least;
  const double right = std::clamp(room - std::max(sizes.left, least.left), least.right,
                                  std::max(sizes.right, least.right));
  const double left = std::clamp(room - right, least.left, std::max(sizes.left, least.left));
  return {left, right};
}

}  // namespace

Layout lay_out(double width, double height, double scale, bool with_panels, bool with_plots,
               const PanelSizes& sizes) {
  Layout layout;
  width = std::max(1.0, width);
  height = std::max(1.0, height);
  if (!with_panels) {
    layout.top = layout.left = layout.right = layout.bottom = layout.plots = {0, 0, 0, 0};
    layout.view = {0, 0, width, height};
    return layout;
  }
  // Whole pixels, and a hair's breadth between neighbours.
  const auto px = [&](double units) { return std::round(units * scale); };
  const double gap = std::max(1.0, px(1));
  const auto [left_units, right_units] = column_widths(sizes, width / scale - least_view_width);
  const double top = px(46), bottom = px(82), left = px(left_units), right = px(right_units);
  const double middle = std::max(1.0, height - top - bottom - 2 * gap);
  layout.top = {0, 0, width, top};
  layout.bottom = {0, height - bottom, width, bottom};
  layout.left = {0, top + gap, left, middle};
  layout.right = {width - right, top + gap, right, middle};
  layout.view = {left + gap, top + gap, std::max(1.0, width - left - right - 2 * gap), middle};
  layout.plots = {0, 0, 0, 0};
  if (with_plots) {
    const double most = std::max(px(least_plots_height), middle - px(least_view_height));
    const double high =
        std::round(sizes.plots > 0 ? std::clamp(sizes.plots * scale, px(least_plots_height), most)
                                   : std::clamp(0.42 * middle, px(190), px(330)));
    layout.view.height = std::max(1.0, middle - high - gap);
    layout.plots = {layout.view.x, layout.view.y + layout.view.height + gap, layout.view.width,
                    high};
  }
  return layout;
}

}  // namespace condyle
