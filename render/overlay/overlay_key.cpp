#include "render/overlay/overlay_key.h"

#include <algorithm>
#include <cmath>

#include "render/image/text_panel_colours.h"

namespace condyle {
namespace {

using Eigen::Vector2d;

// For a picture of 1280 x 720, pixels.
constexpr double row_px = 22, letters_px = 15.3, mark_px = 30, gap_px = 10, pad_px = 12,
                 margin_px = 14, between_px = 18;
constexpr double max_height = 0.41, max_width = 0.46;  // fractions of the picture

struct Columns {
  int rows = 0;
  std::vector<double> widths;  // of the labels
  double scale = 1;            // of all sizes

  double width() const {
    double sum = (2 * pad_px - between_px) * scale;
    for (const double wide : widths) sum += wide + (mark_px + gap_px + between_px) * scale;
    return sum;
  }
  double height() const { return (2 * pad_px + rows * row_px) * scale; }
};

/// As large as space permits; no rows without space.
Columns arranged(const Image& image, const Glyphs& words, std::span<const KeyEntry> key) {
  const double whole = std::clamp(std::min(image.width / 1280.0, image.height / 720.0), 0.4, 8.0);
  constexpr double min_letters_px = 5;
  for (double scale = whole; letters_px * scale > min_letters_px; scale *= 0.9) {
    Columns columns;
    columns.scale = scale;
    const int most = static_cast<int>(
        (max_height * image.height - (margin_px + 2 * pad_px) * scale) / (row_px * scale));
    if (most < 1) continue;
    const int n = static_cast<int>(key.size()), count = (n + most - 1) / most;
    columns.rows = (n + count - 1) / count;
    for (int first = 0; first < n; first += columns.rows) {
      double wide = 0;
      for (int i = first; i < std::min(n, first + columns.rows); ++i)
        wide =
            std::max(wide, words.width(key[static_cast<std::size_t>(i)].words, letters_px * scale));
      columns.widths.push_back(wide);
    }
    if (columns.width() + margin_px * scale <= max_width * image.width) return columns;
  }
  return {};
}

/// On a light background with the border that the lines themselves have there.
void draw_mark(Image& image, const KeyEntry& entry, const PixelBox& box, double scale,
               Backdrop backdrop) {
  const double middle = (box.y0 + box.y1) / 2.0, thick = 1.5 * scale;
  if (entry.mark == KeyEntry::Mark::sheet || entry.mark == KeyEntry::Mark::scale) {
    const int half = static_cast<int>(std::lround(6 * scale));
    for (int x = box.x0; x < box.x1; ++x)
      paint_box(image, {x, static_cast<int>(middle) - half, x + 1, static_cast<int>(middle) + half},
                color_of(entry, (x - box.x0 + 0.5) / (box.x1 - box.x0)));
    if (backdrop == Backdrop::light)
      paint_frame(
          image, {box.x0, static_cast<int>(middle) - half, box.x1, static_cast<int>(middle) + half},
          text_panel_colours(backdrop).faint);
    return;
  }
  const Vector2d from(box.x0 + thick, middle), to(box.x1 - thick, middle);
  const auto draw = [&](double wider, const Eigen::Vector3f& line, const Eigen::Vector3f& dot) {
    stroke(image, from, to, thick + wider, line);
    if (entry.mark == KeyEntry::Mark::path) stroke(image, to, to, 2.6 * thick + wider, dot);
    if (entry.mark == KeyEntry::Mark::arrow)
      for (const double side : {-1.0, 1.0})
        stroke(image, to, to + Vector2d(-5 * thick, side * 3 * thick), thick + wider, line);
  };
  if (backdrop == Backdrop::light) draw(0.8 * scale, line_border, line_border);
  draw(0, entry.colors.front(), entry.colors.back());
}

}  // namespace

KeyEntry ghost_key(const Ghost& ghost) {
  return {"Ghost: at rest", {ghost.color}, KeyEntry::Mark::sheet};
}

Eigen::Vector3f color_of(const KeyEntry& entry, double fraction) {
  if (entry.mark != KeyEntry::Mark::scale) return entry.colors.front();
  const double at = fraction * static_cast<double>(entry.colors.size() - 1);
  const auto before =
      std::min(static_cast<std::size_t>(std::max(0.0, at)), entry.colors.size() - 1);
  const auto after = std::min(before + 1, entry.colors.size() - 1);
  const auto part = static_cast<float>(at - static_cast<double>(before));
  return entry.colors[before] + part * (entry.colors[after] - entry.colors[before]);
}

PixelBox add_key(Image& image, const Glyphs& words, std::span<const KeyEntry> key,
                 Backdrop backdrop) {
  if (key.empty() || !words.has_font()) return {0, 0, 0, 0};
  const Columns columns = arranged(image, words, key);
  if (columns.rows == 0) return {0, 0, 0, 0};
  const double scale = columns.scale;
  const auto px = [&](double units) { return static_cast<int>(std::lround(units * scale)); };
  const PixelBox pane = {px(margin_px), px(margin_px),
                         px(margin_px) + static_cast<int>(std::ceil(columns.width())),
                         px(margin_px) + static_cast<int>(std::ceil(columns.height()))};
  const TextPanelColours colours = text_panel_colours(backdrop);
  shade_box(image, pane, colours.ground, colours.cover);
  double left = pane.x0 + pad_px * scale;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const std::size_t row = i % static_cast<std::size_t>(columns.rows);
    if (i > 0 && row == 0)
      left += columns.widths[i / static_cast<std::size_t>(columns.rows) - 1] +
              (mark_px + gap_px + between_px) * scale;
    const double top = pane.y0 + (pad_px + static_cast<double>(row) * row_px) * scale;
    const PixelBox mark = {static_cast<int>(std::lround(left)), static_cast<int>(std::lround(top)),
                           static_cast<int>(std::lround(left + mark_px * scale)),
                           static_cast<int>(std::lround(top + row_px * scale))};
    draw_mark(image, key[i], mark, scale, backdrop);
    words.write(image, left + (mark_px + gap_px) * scale, top + 0.74 * row_px * scale,
                letters_px * scale, key[i].words, colours.words);
  }
  return pane;
}

}  // namespace condyle
