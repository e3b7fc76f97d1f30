#include "render/plan/picture_grid.h"

#include <algorithm>

#include "render/image/glyphs.h"
#include "render/image/raster_2d.h"

namespace condyle {
namespace {

constexpr int sheet_margin = 24, sheet_gap = 12, title_band = 64, heading_band = 34;
constexpr int sheet_line = 28, sheet_letters = 20, swatch = 18;
const Eigen::Vector3f heading_grey = Eigen::Vector3f::Constant(0.32f);

void copy_into(Image& sheet, const Image& image, int x, int y) {
  const std::size_t row_bytes = 4 * static_cast<std::size_t>(image.width);
  for (int row = 0; row < image.height; ++row)
    std::copy_n(&image.rgba[row * row_bytes], row_bytes,
                &sheet.rgba[4 * (static_cast<std::size_t>(y + row) * sheet.width + x)]);
}

struct PlacedKey {
  int line = 0;
  double x = 0;
};

/// Keys one after another, in as many lines as they need.
std::vector<PlacedKey> placed_keys(const std::vector<ColourKey>& keys, const Glyphs& words,
                                   int width) {
  std::vector<PlacedKey> placed;
  double x = sheet_margin;
  int line = 0;
  for (const ColourKey& key : keys) {
    const double length = swatch + 10 + words.width(key.text, sheet_letters) + 28;
    if (x > sheet_margin && x + length > width - sheet_margin) {
      x = sheet_margin;
      ++line;
    }
    placed.push_back({line, x});
    x += length;
  }
  return placed;
}

}  // namespace

Image draw_grid(const PictureGrid& grid) {
  const Glyphs words;
  const Image& first = grid.rows.front().front().image;
  const int columns = static_cast<int>(grid.rows.front().size());
  Image sheet;
  sheet.width = 2 * sheet_margin + columns * first.width + (columns - 1) * sheet_gap;
  const auto keys = placed_keys(grid.keys, words, sheet.width);
  std::vector<std::string> lines;
  for (const std::string& line : grid.lines)
    for (std::string& part : words.lines(line, sheet_letters, sheet.width - 2 * sheet_margin))
      lines.push_back(std::move(part));
  const int key_lines = keys.empty() ? 0 : keys.back().line + 1;
  const int text_lines = key_lines + static_cast<int>(lines.size());
  const int row_height = heading_band + first.height;
  sheet.height = title_band + static_cast<int>(grid.rows.size()) * row_height + sheet_margin +
                 (text_lines ? text_lines * sheet_line + sheet_margin : 0);
  sheet.rgba.assign(4 * static_cast<std::size_t>(sheet.width) * sheet.height, 255);
  words.write(sheet, sheet_margin, 44, 30, grid.title);
  int y = title_band;
  for (const auto& row : grid.rows) {
    int x = sheet_margin;
    for (const PictureGrid::Panel& panel : row) {
      words.write(sheet, x, y + heading_band - 11, sheet_letters, panel.heading, heading_grey);
      copy_into(sheet, panel.image, x, y + heading_band);
      x += first.width + sheet_gap;
    }
    y += row_height;
  }
  y += sheet_margin;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const int left = static_cast<int>(keys[i].x), top = y + keys[i].line * sheet_line;
    paint_box(sheet, {left, top, left + swatch, top + swatch}, grid.keys[i].color);
    words.write(sheet, left + swatch + 10, top + swatch - 2, sheet_letters, grid.keys[i].text);
  }
  y += key_lines * sheet_line;
  for (const std::string& line : lines) {
    words.write(sheet, sheet_margin, y + swatch - 2, sheet_letters, line);
    y += sheet_line;
  }
  return sheet;
}

}  // namespace condyle
