#include "render/window/layout.h"

#include <algorithm>
#include <cmath>

namespace condyle {

Layout lay_out(double width, double height, double scale, bool with_panels, bool with_plots) {
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
  const double top = px(46), bottom = px(82), left = px(244), right = px(286);
  const double middle = std::max(1.0, height - top - bottom - 2 * gap);
  layout.top = {0, 0, width, top};
  layout.bottom = {0, height - bottom, width, bottom};
  layout.left = {0, top + gap, left, middle};
  layout.right = {width - right, top + gap, right, middle};
  layout.view = {left + gap, top + gap, std::max(1.0, width - left - right - 2 * gap), middle};
  layout.plots = {0, 0, 0, 0};
  if (with_plots) {
    const double high = std::round(std::clamp(0.42 * middle, px(190), px(330)));
    layout.view.height = std::max(1.0, middle - high - gap);
    layout.plots = {layout.view.x, layout.view.y + layout.view.height + gap, layout.view.width,
                    high};
  }
  return layout;
}

}  // namespace condyle
