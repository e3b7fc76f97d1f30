#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "render/image/text_panel_colours.h"
#include "render/overlay/overlays.h"
#include "render/overlay/place_labels.h"
#include "render/scene/displacement_drawing.h"
#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

ImU32 ink_of(const Eigen::Vector3f& c) {
  return ImGui::ColorConvertFloat4ToU32({c.x(), c.y(), c.z(), 1});
}

/// Draws a mark of the given width from the middle of its left end, with the border that lines have
/// on a light view.
void key_mark(ImDrawList& list, const KeyEntry& entry, const ImVec2& from, float width, float px,
              bool bordered) {
  const ImVec2 to = {from.x + width, from.y};
  if (entry.mark == KeyEntry::Mark::sheet || entry.mark == KeyEntry::Mark::scale) {
    const int steps = static_cast<int>(width);
    for (int i = 0; i < steps; ++i) {
      const float x = from.x + static_cast<float>(i);
      list.AddRectFilled({x, from.y - 5 * px}, {x + 1, from.y + 5 * px},
                         ink_of(color_of(entry, (i + 0.5) / steps)));
    }
    if (bordered)
      list.AddRect({from.x, from.y - 5 * px}, {to.x, from.y + 5 * px}, palette().outline, 0, 0, px);
    return;
  }
  const auto draw = [&](float border, ImU32 line, ImU32 dot) {
    list.AddLine({from.x - border, from.y}, {to.x + border, to.y}, line, 2.4f * px + 2 * border);
    if (entry.mark == KeyEntry::Mark::path)
      list.AddCircleFilled({to.x - 3 * px, to.y}, 3 * px + border, dot);
    if (entry.mark == KeyEntry::Mark::arrow)
      for (const float side : {-1.f, 1.f})
        list.AddLine(to, {to.x - 6 * px, to.y + side * 3.5f * px}, line, 2 * px + 2 * border);
  };
  if (bordered) draw(0.9f * px, ink_of(line_border), ink_of(line_border));
  draw(0, ink_of(entry.colors.front()), ink_of(entry.colors.back()));
}

}  // namespace

/// Shown while a surface is coloured by values.
ViewRect Panels::Drawing::legend() {
  const bool distances = view.distances && input.scene.distance_colours;
  if (!distances && !view.look.displacement) return {};
  const Theme& theme = panels.theme_;
  const ColourMap map = distances ? *input.scene.distance_colours : displacement_map();
  const auto& remarks = distances ? input.scene.distance_remarks : displacement_remarks();
  const ViewRect& r = layout.view;
  const float letters = theme.small->FontSize, pad = pen.px(10), bar_width = pen.px(18);
  const float bar_height = pen.px(150), title = theme.regular->FontSize + pen.px(8);
  const float line = letters + pen.px(3);
  float wide = pen.px(136);
  for (const auto& remark : remarks) wide = std::max(wide, text_width(theme.small, remark));
  const float high =
      title + bar_height + pen.px(8) + line + line * static_cast<float>(remarks.size());
  const double pane_width = wide + 2 * pad, pane_height = high + 2 * pad;
  if (r.width < 2.5 * pane_width || r.height < 1.4 * pane_height) return {};  // no space
  const ViewRect pane = {r.x + pad, r.y + r.height - pad - pane_height, pane_width, pane_height};
  panels.items_.push_back({"legend", "", pane});

  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImVec2 low = {static_cast<float>(pane.x), static_cast<float>(pane.y)};
  list.AddRectFilled(
      low, {low.x + static_cast<float>(pane.width), low.y + static_cast<float>(pane.height)},
      palette().floating, pen.px(4));
  const auto words = [&](ImFont* font, ImU32 tint, float x, float y, const std::string& text) {
    list.AddText(font, font->FontSize, {std::round(x), std::round(y)}, tint, text.c_str());
  };
  const float left = low.x + pad, right = left + bar_width;
  const float top = low.y + pad + title, bottom = top + bar_height;
  words(theme.regular, palette().text, left, low.y + pad, map.title + ", " + map.unit);
  const auto y_of = [&](float value) {
    return bottom - (value - map.low()) / (map.high() - map.low()) * bar_height;
  };
  const int rows = static_cast<int>(bar_height);
  for (int i = 0; i < rows; ++i) {
    const float s = (static_cast<float>(i) + 0.5f) / static_cast<float>(rows);
    const float y = bottom - s * bar_height;
    list.AddRectFilled({left, y - 0.5f}, {right, y + 1.5f},
                       ink_of(color_of(map, map.low() + s * (map.high() - map.low()))));
  }
  list.AddRect({left, top}, {right, bottom}, palette().outline, 0, 0, pen.px(1));
  for (const float value : map.lines)
    list.AddLine({left, y_of(value)}, {right, y_of(value)}, colour::rgb(0x1a1a1a), pen.px(1));
  float numbers = 0;
  for (const float tick : map.ticks) {
    const float y = y_of(tick);
    list.AddLine({right, y}, {right + pen.px(4), y}, palette().text_dim, pen.px(1));
    const std::string number =
        tick < -1e-4f ? fmt::format("-{:g}", -tick) : fmt::format("{:g}", std::abs(tick));
    words(theme.small, palette().text, right + pen.px(7), y - letters / 2, number);
    numbers = std::max(numbers, text_width(theme.small, number));
  }
  for (const auto& band : map.bands)
    words(theme.small, palette().text_dim, right + pen.px(15) + numbers,
          (y_of(band.from) + y_of(band.to) - letters) / 2, band.name);
  float y = bottom + pen.px(8);
  list.AddRectFilled({left, y + pen.px(1)}, {right, y + letters}, ink_of(map.beyond));
  words(theme.small, palette().text, right + pen.px(7), y,
        fmt::format("more than {:g}", map.high()));
  for (const auto& remark : remarks)
    words(theme.small, palette().text_dim, left, y += line, remark);
  return pane;
}

/// Marks of overlays with their meanings, in columns, down to the cube.
ViewRect Panels::Drawing::key() {
  std::vector<KeyEntry> entries(input.key.begin(), input.key.end());
  if (view.look.ghost) entries.push_back(ghost_key({}));
  if (entries.empty()) return {};
  const Theme& theme = panels.theme_;
  const ViewRect& r = layout.view;
  const float letters = theme.small->FontSize, pad = pen.px(10), row = letters + pen.px(5);
  const float mark = pen.px(24), gap = pen.px(8), between = pen.px(14);
  const auto most = static_cast<int>((r.height - pen.px(92 + 20 + 10) - 2 * pad) / row);
  if (most < 1) return {};
  const auto n = static_cast<int>(entries.size());
  const int rows = (n + (n + most - 1) / most - 1) / ((n + most - 1) / most);
  std::vector<float> widths;  // of the words
  float wide = 2 * pad - between;
  for (int first = 0; first < n; first += rows) {
    widths.push_back(0);
    for (int i = first; i < std::min(n, first + rows); ++i)
      widths.back() = std::max(widths.back(),
                               text_width(theme.small, entries[static_cast<std::size_t>(i)].words));
    wide += mark + gap + widths.back() + between;
  }
  const double margin = std::round(pen.px(10));
  const ViewRect pane = {r.x + r.width - margin - wide, r.y + margin, wide,
                         2.0 * pad + rows * row - pen.px(5)};
  if (pane.width > 0.5 * r.width) return {};  // no space
  panels.items_.push_back({"key", "", pane});
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImVec2 low = {static_cast<float>(pane.x), static_cast<float>(pane.y)};
  list.AddRectFilled(
      low, {low.x + static_cast<float>(pane.width), low.y + static_cast<float>(pane.height)},
      palette().floating, pen.px(4));
  float left = low.x + pad;
  for (int i = 0; i < n; ++i) {
    if (i > 0 && i % rows == 0)
      left += mark + gap + widths[static_cast<std::size_t>(i / rows - 1)] + between;
    const KeyEntry& entry = entries[static_cast<std::size_t>(i)];
    const float top = low.y + pad + static_cast<float>(i % rows) * row;
    key_mark(list, entry, {left, top + letters / 2}, mark, pen.px(1), theme.light);
    list.AddText(theme.small, letters, {std::round(left + mark + gap), std::round(top)},
                 palette().text, entry.words.c_str());
  }
  return pane;
}

/// Names at places of overlays, each with a line to its place.
void Panels::Drawing::overlay_labels() {
  if (input.labels.empty()) return;
  const Theme& theme = panels.theme_;
  const ViewRect& r = layout.view;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float letters = theme.small->FontSize, row = letters + pen.px(4), pad = pen.px(3);
  const auto on_screen = [&](const Eigen::Vector2d& p) {
    return ImVec2{static_cast<float>(r.x + p.x()), static_cast<float>(r.y + p.y())};
  };
  for (const PlacedLabel& label :
       placed_labels(input.labels, input.camera, {r.width, r.height}, row,
                     [&](const std::string& words) { return text_width(theme.small, words); })) {
    const ImVec2 place = on_screen(label.place), corner = on_screen(label.corner);
    const auto wide = static_cast<float>(label.width);
    const bool left = corner.x < place.x;
    const ImVec2 end = {left ? corner.x + wide + pad : corner.x - pad, corner.y + row / 2};
    list.AddLine(place, end, palette().text, pen.px(1));
    list.AddCircleFilled(place, pen.px(2), palette().text, 12);
    list.AddRectFilled({corner.x - pad, corner.y}, {corner.x + wide + pad, corner.y + row},
                       palette().floating, pen.px(3));
    list.AddText(theme.small, letters, {std::round(corner.x), std::round(corner.y + pen.px(2))},
                 palette().text, label.words.c_str());
    panels.items_.push_back(
        {"label:" + label.words, "", {corner.x, corner.y, wide, row}, label.words});
  }
}

void Panels::Drawing::hover_text() {
  if (!input.hover_text.empty()) beside_mouse(input.hover_text);
}

void Panels::Drawing::beside_mouse(const std::string& words) {
  const Theme& theme = panels.theme_;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const float pad = pen.px(6), high = theme.regular->FontSize + 2 * pad;
  const float wide = text_width(theme.regular, words) + 2 * pad;
  const ViewRect& r = layout.view;
  const float x = std::min(mouse.x + pen.px(14), static_cast<float>(r.x + r.width) - wide);
  const float y = std::max(mouse.y - pen.px(10) - high, static_cast<float>(r.y));
  panels.items_.push_back({"beside-mouse", "", {x, y, wide, high}, words});
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled({x, y}, {x + wide, y + high}, palette().floating, pen.px(4));
  list.AddText(theme.regular, theme.regular->FontSize, {std::round(x + pad), std::round(y + pad)},
               palette().text, words.c_str());
}

}  // namespace condyle
