#include "render/overlay/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/image/raster_2d.h"
#include "render/image/text_panel_colours.h"

namespace condyle {

int legend_height(const LegendLayout& layout) {
  return layout.bar_height + static_cast<int>(std::lround(4.4 * layout.letters));
}

void draw_legend(Image& image, const Glyphs& words, const ColourMap& map,
                 const LegendLayout& layout) {
  const double letters = layout.letters;
  const int left = layout.left, right = left + layout.bar_width;
  const int top = layout.top + static_cast<int>(std::lround(1.9 * letters));
  const int bottom = top + layout.bar_height;
  const int line = std::max(1, static_cast<int>(std::lround(letters / 18)));
  const auto y_of = [&](float value) {
    return static_cast<float>(bottom) -
           (value - map.low()) / (map.high() - map.low()) * static_cast<float>(layout.bar_height);
  };
  words.write(image, left, layout.top + letters, 1.1 * letters, map.title + ", " + map.unit,
              layout.ink);
  for (int y = top; y < bottom; ++y) {
    const float s = (static_cast<float>(bottom - y) - 0.5f) / static_cast<float>(layout.bar_height);
    paint_box(image, {left, y, right, y + 1},
              color_of(map, map.low() + s * (map.high() - map.low())));
  }
  for (const float value : map.lines) {
    const int y = static_cast<int>(std::lround(y_of(value)));
    paint_box(image, {left, y, right, y + line}, Eigen::Vector3f::Constant(0.1f));
  }
  paint_frame(image, {left, top, right, bottom}, layout.faint, line);
  double widest = 0;
  for (const float tick : map.ticks) {
    const int y = static_cast<int>(std::lround(y_of(tick)));
    paint_box(image, {right, y, right + 6 * line, y + line}, layout.faint);
    const std::string number =
        tick < -1e-4f ? fmt::format("\u2212{:g}", -tick) : fmt::format("{:g}", std::abs(tick));
    words.write(image, right + 10 * line, y + letters / 3, letters, number, layout.ink);
    widest = std::max(widest, words.width(number, letters));
  }
  // Labels of narrow bands are moved apart, from the lowest up.
  std::vector<std::pair<double, std::string>> names;
  for (const auto& band : map.bands)
    names.emplace_back((y_of(band.from) + y_of(band.to)) / 2 + letters / 3, band.name);
  std::sort(names.rbegin(), names.rend());
  double free = image.height;
  for (const auto& [y, name] : names) {
    const double at = std::min(y, free);
    words.write(image, right + 18 * line + widest, at, 0.95 * letters, name, layout.faint);
    free = at - 1.1 * letters;
  }
  const int patch = static_cast<int>(std::lround(letters));
  paint_box(image, {left, bottom + patch, right, bottom + 2 * patch}, map.beyond);
  words.write(image, right + 10 * line, bottom + 1.85 * patch, 0.95 * letters,
              map.beyond_name.empty() ? fmt::format("more than {:g}", map.high()) : map.beyond_name,
              layout.ink);
}

PixelBox add_legend(Image& image, const Glyphs& words, const ColourMap& map,
                    const std::vector<std::string>& remarks, Backdrop backdrop) {
  const double scale = std::clamp(std::min(image.width / 1280.0, image.height / 720.0), 0.4, 8.0);
  const auto px = [&](double units) { return static_cast<int>(std::lround(units * scale)); };
  LegendLayout layout;
  layout.letters = 18 * scale;
  layout.bar_width = px(26);
  layout.bar_height = px(230);
  const TextPanelColours colours = text_panel_colours(backdrop);
  layout.ink = colours.words;
  layout.faint = colours.faint;
  double wide = px(176);
  for (const auto& remark : remarks)
    wide = std::max(wide, words.width(remark, 0.85 * layout.letters));
  const int line = px(22), margin = px(14), pad = px(14);
  const int high = legend_height(layout) + line * static_cast<int>(remarks.size());
  layout.left = margin + pad;
  layout.top = image.height - margin - pad - high;
  const PixelBox pane = {margin, layout.top - pad, margin + 2 * pad + static_cast<int>(wide),
                         image.height - margin};
  shade_box(image, pane, colours.ground, colours.cover);
  draw_legend(image, words, map, layout);
  double y = layout.top + legend_height(layout) + 0.9 * line;
  for (const auto& remark : remarks) {
    words.write(image, layout.left, y, 0.85 * layout.letters, remark, layout.ink);
    y += line;
  }
  return pane;
}

}  // namespace condyle
