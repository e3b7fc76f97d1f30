#include "render/window/settings/layout.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

// Minimum size of the picture, regardless of the columns and plots, at scale 1.
constexpr double min_view_width = 320, min_view_height = 160, min_plots_height = 150;
// Size of a tool; as high as the highest one requires.
constexpr double tool_width = 252, min_tool_height = 306;

/// Reserves a column for the tool left of the view, unless the window is too small for both.
void dock_tool(Layout& layout, double scale, double gap) {
  ViewRect& view = layout.view;
  const double wide = std::round(tool_width * scale);
  if (view.width < 1.6 * wide || view.height < min_tool_height * scale) return;
  layout.tool = {view.x, view.y, wide, view.height};
  view.x += wide + gap;
  view.width -= wide + gap;
}

/// Two columns that leave space for the picture: the right one shrinks first.
std::pair<double, double> column_widths(const PanelSizes& sizes, double room) {
  const PanelSizes least;
  const double right = std::clamp(room - std::max(sizes.left, least.left), least.right,
                                  std::max(sizes.right, least.right));
  const double left = std::clamp(room - right, least.left, std::max(sizes.left, least.left));
  return {left, right};
}

}  // namespace

Layout lay_out(double width, double height, double scale, bool with_panels, const Beside& beside,
               const PanelSizes& sizes) {
  Layout layout;
  layout.tool = {0, 0, 0, 0};
  width = std::max(1.0, width);
  height = std::max(1.0, height);
  if (!with_panels) {
    layout.top = layout.left = layout.right = layout.bottom = layout.plots = {0, 0, 0, 0};
    layout.view = {0, 0, width, height};
    if (beside.tool) dock_tool(layout, scale, std::max(1.0, std::round(scale)));
    return layout;
  }
  // Whole pixels, and a thin gap between neighbours.
  const auto px = [&](double units) { return std::round(units * scale); };
  const double gap = std::max(1.0, px(1));
  const double min_width = min_view_width + (beside.tool ? tool_width + 1 : 0);
  const auto [left_units, right_units] = column_widths(sizes, width / scale - min_width);
  const double top = px(46), bottom = px(82), left = px(left_units), right = px(right_units);
  const double middle = std::max(1.0, height - top - bottom - 2 * gap);
  layout.top = {0, 0, width, top};
  layout.bottom = {0, height - bottom, width, bottom};
  layout.left = {0, top + gap, left, middle};
  layout.right = {width - right, top + gap, right, middle};
  layout.view = {left + gap, top + gap, std::max(1.0, width - left - right - 2 * gap), middle};
  layout.plots = {0, 0, 0, 0};
  if (beside.plots) {
    const double kept = px(beside.tool ? min_tool_height : min_view_height) + gap;
    const double most = std::max(px(min_plots_height), middle - kept);
    const double high =
        std::round(sizes.plots > 0 ? std::clamp(sizes.plots * scale, px(min_plots_height), most)
                                   : std::min(most, std::clamp(0.42 * middle, px(190), px(330))));
    layout.view.height = std::max(1.0, middle - high - gap);
    layout.plots = {layout.view.x, layout.view.y + layout.view.height + gap, layout.view.width,
                    high};
  }
  if (beside.tool) dock_tool(layout, scale, gap);
  return layout;
}

}  // namespace condyle
