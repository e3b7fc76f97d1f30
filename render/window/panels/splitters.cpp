#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "render/window/panels/panels_drawing.h"

namespace condyle {

/// A splitter between two panels. `size`: of the panel that it resizes, pixels; `direction`: 1
/// where that grows with the mouse's coordinate, -1 where it shrinks. Returns the requested size at
/// scale 1, or `reset` after a double click.
std::optional<double> Panels::Drawing::edge(const char* name, const ViewRect& place, double size,
                                            double direction, double reset) {
  const bool upright = place.height > place.width;
  ImGui::PushStyleColor(ImGuiCol_WindowBg, colour::rgb(0, 0));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2{0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2{1, 1});
  begin_panel(pen, name, place);
  const ImVec2 extent = ImGui::GetWindowSize(), low = ImGui::GetWindowPos();
  ImGui::InvisibleButton("grip", extent);
  const bool held = ImGui::IsItemActive();
  if (held || ImGui::IsItemHovered()) {
    ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
    const float thick = std::max(1.0f, pen.px(2));
    const ImVec2 half = {upright ? thick / 2 : extent.x / 2, upright ? extent.y / 2 : thick / 2};
    const ImVec2 middle = {low.x + extent.x / 2, low.y + extent.y / 2};
    ImGui::GetWindowDrawList()->AddRectFilled({middle.x - half.x, middle.y - half.y},
                                              {middle.x + half.x, middle.y + half.y},
                                              palette().accent);
  }
  if (!held) tooltip(pen, "Drag to change the size; double-click to reset it");
  std::optional<double> new_size;
  const double scale = panels.theme_.scale;
  if (ImGui::IsItemActivated()) panels.gripped_size_ = size / scale;
  if (held && ImGui::IsMouseDoubleClicked(0)) {
    new_size = panels.gripped_size_ = reset;
  } else if (held && ImGui::IsMouseDragging(0, 1)) {
    const ImVec2 mouse = ImGui::GetIO().MousePos, from = ImGui::GetIO().MouseClickedPos[0];
    new_size =
        panels.gripped_size_ +
        direction * static_cast<double>(upright ? mouse.x - from.x : mouse.y - from.y) / scale;
  }
  end_panel();
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
  return new_size;
}

void Panels::Drawing::edges() {
  const ViewRect &left = layout.left, &right = layout.right, &plots = layout.plots;
  const PanelSizes defaults;
  constexpr double most = 4000;
  // Wide enough to hit, and on the picture's side, where no panel has anything to click.
  const double wide = std::round(static_cast<double>(pen.px(6)));
  PanelSizes& sizes = panels.sizes_;
  if (const auto size =
          edge("edge:left", {left.width, left.y, wide, left.height}, left.width, 1, defaults.left))
    sizes.left = std::clamp(*size, defaults.left, most);
  if (const auto size = edge("edge:right", {right.x - wide, right.y, wide, right.height},
                             right.width, -1, defaults.right))
    sizes.right = std::clamp(*size, defaults.right, most);
  if (plots.height <= 0) return;
  if (const auto size =
          edge("edge:plots", {plots.x + wide, plots.y - wide, plots.width - 2 * wide, wide},
               plots.height, -1, defaults.plots))
    sizes.plots = std::clamp(*size, defaults.plots, most);
}

}  // namespace condyle
