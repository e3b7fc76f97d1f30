#include <imgui.h>

#include <array>
#include <cmath>

#include "render/window/handles.h"
#include "render/window/panels_drawing.h"
#include "sim/frame/plot_places.h"

namespace condyle {

void Panels::Drawing::measuring() {
  const bool in_use = view.tool == Tool::measure;
  if (!input.frame || (!in_use && view.measured.empty())) return;
  const Theme& theme = panels.theme_;
  std::vector<Eigen::Vector3d> places, seen;
  for (const auto& point : view.measured) {
    places.push_back(place_of(point, input.scene.parts, *input.frame));
    seen.push_back(place_of(point, input.scene.parts, *input.frame, input.seen_face));
  }
  const Measured result = measured(places);

  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ViewRect& r = layout.view;
  list.PushClipRect({static_cast<float>(r.x), static_cast<float>(r.y)},
                    {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  constexpr ImU32 tint = colour::rgb(0xf0e442), edge = colour::rgb(0x0f1215, 200);
  std::vector<ImVec2> line;
  for (const auto& p : seen) {
    const auto at = screen_place(input.camera, r, p);
    line.push_back({static_cast<float>(at.x()), static_cast<float>(at.y())});
  }
  const auto stroke = [&](ImU32 ink, float wide) {
    list.AddPolyline(line.data(), static_cast<int>(line.size()), ink, 0, pen.px(wide));
  };
  if (line.size() > 1) {
    stroke(edge, 4.5f);
    stroke(tint, 2);
  }
  for (const ImVec2& p : line) {
    list.AddCircleFilled(p, pen.px(5.5f), edge, 20);
    list.AddCircleFilled(p, pen.px(4), tint, 20);
  }
  if (line.size() > 1) {
    const std::string words = words_of(result)[line.size() == 3 ? 1 : 0];
    const ImVec2 extent = theme.bold->CalcTextSizeA(theme.bold->FontSize, 1e6f, 0, words.c_str());
    // Beside the point that it speaks of, and no line behind it.
    const ImVec2 from = line.size() == 3 ? line[1] : line.back();
    const float pad = pen.px(6), away = pen.px(7);
    WordPlaces clear({r.x, r.y, r.x + r.width, r.y + r.height}, pen.px(1.5f));
    std::vector<WordPlaces::Point> way;
    for (const ImVec2& p : line) way.push_back({p.x, p.y});
    clear.add_curve(way);
    const auto place = clear.take(extent.x + 2 * pad, extent.y + pen.px(6),
                                  {from.x - away, from.y - away, from.x + away, from.y + away});
    const ImVec2 at = {std::round(static_cast<float>(place.x) + pad),
                       std::round(static_cast<float>(place.y) + pen.px(3))};
    list.AddRectFilled({at.x - pen.px(5), at.y - pen.px(2)},
                       {at.x + extent.x + pen.px(5), at.y + extent.y + pen.px(2)}, edge, pen.px(4));
    list.AddText(theme.bold, theme.bold->FontSize, at, tint, words.c_str());
    pen.items.push_back({"measure-label", "view", {at.x, at.y, extent.x, extent.y}, words});
  }
  list.PopClipRect();

  if (!in_use || layout.tool.width <= 0) return;
  begin_panel(pen, "measure", layout.tool);
  const std::size_t count = places.size();
  heading(pen, "Measure",
          count == 0 ? "" : std::to_string(count) + (count == 1 ? " point" : " points"));
  if (places.size() < 2) {
    ImGui::PushTextWrapPos(0);
    text(theme.small, palette().text_dim,
         "Click two points for a distance, three for an angle and an area, more for a way and an "
         "area. They stay on their bone or skin until they are cleared.");
    ImGui::PopTextWrapPos();
  } else {
    constexpr std::array names = {"Length", "Angle", "Area"};
    const auto words = words_of(result);
    const auto row = [&](const char* name, const std::string& value) {
      text(theme.regular, palette().text_dim, name);
      ImGui::SameLine();
      text_right(theme.regular, palette().text, value);
      pen.mark(std::string("measured:") + name);
    };
    row(names[0], words[0]);
    if (result.angle_deg) row(names[1], words[1]);
    if (result.area_mm2) row(names[2], words.back());
  }
  const float gap = pen.px(5);
  const ImVec2 size = {std::floor((ImGui::GetContentRegionAvail().x - gap) / 2), pen.px(26)};
  ImGui::SetCursorPosY(pen.px(136));  // below the longest words: buttons do not move
  ImGui::BeginDisabled(places.empty());
  if (word_button(pen, "measure-back", "Last off", size, false)) {
    view.measured.pop_back();
  }
  ImGui::SameLine(0, gap);
  if (word_button(pen, "measure-clear", "Clear", size, false)) {
    view.measured.clear();
  }
  ImGui::EndDisabled();
  end_panel();
}

}  // namespace condyle
