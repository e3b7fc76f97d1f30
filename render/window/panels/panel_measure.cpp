#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "render/window/input/gizmos.h"
#include "render/window/panels/panels_drawing.h"
#include "sim/frame/label_placement.h"

namespace condyle {
namespace {

constexpr ImU32 measure_colour = colour::rgb(0xf0e442), measure_edge = colour::rgb(0x0f1215, 200);

/// The measures and the points for a spreadsheet: fields separated by tabs.
std::string measured_table(const Measured& measured, std::span<const Eigen::Vector3d> points) {
  std::string table = fmt::format("length_mm\t{:.3f}\n", measured.length_mm);
  if (measured.angle_deg) table += fmt::format("angle_deg\t{:.3f}\n", *measured.angle_deg);
  if (measured.area_mm2) table += fmt::format("area_mm2\t{:.3f}\n", *measured.area_mm2);
  table += "point\tx_mm\ty_mm\tz_mm\n";
  for (std::size_t i = 0; i < points.size(); ++i)
    table += fmt::format("{}\t{:.3f}\t{:.3f}\t{:.3f}\n", i + 1, points[i].x(), points[i].y(),
                         points[i].z());
  return table;
}

}  // namespace

void Panels::Drawing::measuring() {
  const bool in_use = view.tool == Tool::measure;
  if (!input.frame || (!in_use && view.measured.empty())) return;
  std::vector<Eigen::Vector3d> places;
  for (const auto& point : view.measured)
    places.push_back(place_of(point, input.scene.parts, *input.frame));
  const Measured result = measured(places);
  measured_line(result);
  if (in_use && layout.tool.width > 0) measure_panel(result, places);
}

/// Points, line and number on the picture. A single point has a hint on the next step.
void Panels::Drawing::measured_line(const Measured& result) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ViewRect& r = layout.view;
  list.PushClipRect({static_cast<float>(r.x), static_cast<float>(r.y)},
                    {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  std::vector<ImVec2> line;
  for (const auto& point : view.measured) {
    const auto at = screen_place(
        input.camera, r, place_of(point, input.scene.parts, *input.frame, input.displayed_face));
    line.push_back({static_cast<float>(at.x()), static_cast<float>(at.y())});
  }
  const auto stroke = [&](ImU32 ink, float wide) {
    list.AddPolyline(line.data(), static_cast<int>(line.size()), ink, 0, pen.px(wide));
  };
  if (line.size() > 1) {
    stroke(measure_edge, 4.5f);
    stroke(measure_colour, 2);
  }
  for (const ImVec2& p : line) {
    list.AddCircleFilled(p, pen.px(5.5f), measure_edge, 20);
    list.AddCircleFilled(p, pen.px(4), measure_colour, 20);
  }
  if (line.size() > 1)
    measure_label(line, words_of(result)[line.size() == 3 ? 1 : 0]);
  else if (line.size() == 1 && view.tool == Tool::measure)
    measure_label(line, "to a second point");
  list.PopClipRect();
}

/// Position of the text beside its point, where no line passes behind it.
void Panels::Drawing::measure_label(std::span<const ImVec2> line, const std::string& words) {
  const Theme& theme = panels.theme_;
  const ViewRect& r = layout.view;
  const ImVec2 extent = theme.bold->CalcTextSizeA(theme.bold->FontSize, 1e6f, 0, words.c_str());
  const ImVec2 from = line.size() == 3 ? line[1] : line.back();
  const float pad = pen.px(6), away = pen.px(7);
  LabelPlacement clear({r.x, r.y, r.x + r.width, r.y + r.height}, pen.px(1.5f));
  std::vector<LabelPlacement::Point> path;
  for (const ImVec2& p : line) path.push_back({p.x, p.y});
  clear.add_curve(path);
  const auto place = clear.take(extent.x + 2 * pad, extent.y + pen.px(6),
                                {from.x - away, from.y - away, from.x + away, from.y + away});
  const ImVec2 at = {std::round(static_cast<float>(place.x) + pad),
                     std::round(static_cast<float>(place.y) + pen.px(3))};
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled({at.x - pen.px(5), at.y - pen.px(2)},
                     {at.x + extent.x + pen.px(5), at.y + extent.y + pen.px(2)}, measure_edge,
                     pen.px(4));
  list.AddText(theme.bold, theme.bold->FontSize, at, measure_colour, words.c_str());
  pen.items.push_back({"measure-label", "view", {at.x, at.y, extent.x, extent.y}, words});
}

void Panels::Drawing::measure_panel(const Measured& result,
                                    std::span<const Eigen::Vector3d> places) {
  const Theme& theme = panels.theme_;
  begin_panel(pen, "measure", layout.tool);
  const std::size_t count = places.size();
  heading(pen, "Measure",
          count == 0 ? "" : std::to_string(count) + (count == 1 ? " point" : " points"));
  if (count < 2) {
    ImGui::PushTextWrapPos(0);
    text(theme.small, palette().text_dim,
         "Click two points for a distance, three for an angle and an area, more for a path and an "
         "area. They stay on their bone or skin until they are cleared.");
    ImGui::PopTextWrapPos();
  } else {
    const auto words = words_of(result);
    const auto row = [&](const char* name, const std::string& value) {
      text(theme.regular, palette().text_dim, name);
      ImGui::SameLine();
      text_right(theme.regular, palette().text, value);
      pen.mark(std::string("measured:") + name);
    };
    row("Length", words[0]);
    if (result.angle_deg) row("Angle", words[1]);
    if (result.area_mm2) row("Area", words.back());
  }
  measure_buttons(result, places);
  end_panel();
}

void Panels::Drawing::measure_buttons(const Measured& result,
                                      std::span<const Eigen::Vector3d> places) {
  const float gap = pen.px(button_gap), room = ImGui::GetContentRegionAvail().x - 2 * gap;
  const ImVec2 wide = {std::floor(0.44f * room), pen.px(26)},
               size = {std::floor(0.28f * room), wide.y};
  ImGui::SetCursorPosY(pen.px(136));  // below the longest text, so that the buttons do not move
  ImGui::BeginDisabled(places.empty());
  if (word_button(pen, "measure-back", "Remove last", wide, false)) view.measured.pop_back();
  ImGui::SameLine(0, gap);
  if (word_button(pen, "measure-clear", "Clear", size, false)) view.measured.clear();
  ImGui::SameLine(0, gap);
  if (word_button(pen, "measure-copy", "Copy", size, false)) {
    ImGui::SetClipboardText(measured_table(result, places).c_str());
    panels.say("Copied: the numbers and the points, for a spreadsheet");
  }
  tooltip(pen, "Copies the numbers and the points' places (mm, in the cranium's frame)");
  ImGui::EndDisabled();
}

}  // namespace condyle
