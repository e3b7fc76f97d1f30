#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "render/window/input/gizmos.h"
#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

constexpr ImU32 cut_colour = colour::rgb(0xf0e442), cut_edge = colour::rgb(0x0f1215, 200);
constexpr double largest_kerf_mm = 2, largest_depth_mm = 200;

ImVec2 pixel(const Eigen::Vector2d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y())};
}

}  // namespace

const PlanNumber* number_of(const PlanView& plan, const PlanHandle& handle) {
  for (const PlanStepView& step : plan.steps)
    if (step.id == plan.handles_of)
      for (const PlanNumber& number : step.numbers)
        if (number.name == handle.number) return &number;
  return nullptr;
}

std::optional<PlanEdit> drawn_cut_edit(const WindowScene& scene, const ViewState& view) {
  const DrawnCut& drawn = view.drawn_cut;
  if (view.tool != Tool::cut || !drawn.part || drawn.points.size() < 2) return std::nullopt;
  return plan_edit::DrawCut{scene.parts[*drawn.part].name, drawn.points, drawn.direction,
                            drawn.depth_mm, drawn.kerf_mm};
}

void Panels::accept_cut(const WindowScene& scene, const ViewState& view) {
  const auto edit = drawn_cut_edit(scene, view);
  if (edit && form_.requested_cut == view.drawn_cut) return;  // it is being made
  form_.requested_cut = view.drawn_cut;
  if (edit)
    request(request::EditPlan{*edit});
  else
    say("A cut needs at least two points");
}

void Panels::Drawing::cutting() {
  if (!input.frame) return;
  preview_drawn_cut();
  if (panels.shows_handles(view)) plan_handles();
  if (view.tool != Tool::cut) return;
  drawn_cut_line();
  if (layout.tool.width > 0) cut_panel();
}

/// Requests a preview after each change of the drawn cut.
void Panels::Drawing::preview_drawn_cut() {
  auto& previewed = panels.form_.previewed_cut;
  const auto edit = drawn_cut_edit(input.scene, view);
  const DrawnCut now = edit ? view.drawn_cut : DrawnCut{};
  if (now == previewed) return;
  previewed = now;
  panels.request(request::PreviewCut{edit});
}

/// Points and line of the drawn cut, on the picture.
void Panels::Drawing::drawn_cut_line() {
  const DrawnCut& drawn = view.drawn_cut;
  if (!drawn.part) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ViewRect& r = layout.view;
  list.PushClipRect({static_cast<float>(r.x), static_cast<float>(r.y)},
                    {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  const Pose& X_CB = input.frame->poses[input.scene.parts[*drawn.part].body];
  std::vector<ImVec2> line;
  for (const auto& p : drawn.points) line.push_back(pixel(screen_place(input.camera, r, X_CB * p)));
  for (const auto& [ink, wide] : {std::pair{cut_edge, 4.5f}, {cut_colour, 2.f}})
    list.AddPolyline(line.data(), static_cast<int>(line.size()), ink, 0, pen.px(wide));
  for (std::size_t i = 0; i < line.size(); ++i) {
    list.AddCircleFilled(line[i], pen.px(6), cut_edge, 20);
    list.AddCircleFilled(line[i], pen.px(4.5f), cut_colour, 20);
    pen.items.push_back(
        {fmt::format("cut-point:{}", i + 1), "view", {line[i].x - 4.0, line[i].y - 4.0, 8, 8}});
  }
  list.PopClipRect();
}

/// Handles of the plan's selected step: arrows change a number, dots place a point.
void Panels::Drawing::plan_handles() {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ViewRect& r = layout.view;
  const PlanView& plan = input.scene.plan;
  list.PushClipRect({static_cast<float>(r.x), static_cast<float>(r.y)},
                    {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  std::string hovered;
  for (std::size_t i = 0; i < plan.handles.size(); ++i) {
    const PlanHandle& handle = plan.handles[i];
    const PlanNumber* number = number_of(plan, handle);
    const bool held =
        view.held_handle && !view.held_handle->is_drawn && view.held_handle->index == i;
    const Pose& X_CB = input.frame->poses[handle.body];
    const Eigen::Vector3d place = X_CB * (held ? view.held_handle->at : handle.at);
    const auto at = screen_place(input.camera, r, place);
    if (number) {
      // An arrow to both sides, of a constant length on the screen.
      Eigen::Vector2d along =
          screen_place(input.camera, r, place + X_CB.R * handle.per_unit.normalized()) - at;
      along = along.norm() > 0.3 ? along.normalized() : Eigen::Vector2d::Zero();
      for (const auto& [ink, wide] : {std::pair{cut_edge, 4.5f}, {cut_colour, 2.f}})
        list.AddLine(pixel(at - pen.px(17) * along), pixel(at + pen.px(17) * along), ink,
                     pen.px(wide));
    }
    list.AddCircleFilled(pixel(at), pen.px(7), cut_edge, 20);
    list.AddCircleFilled(pixel(at), pen.px(5.5f), held ? colour::rgb(0xffffff) : cut_colour, 20);
    const std::string words =
        number ? fmt::format("{} {:.1f} {}", number->label,
                             held ? view.held_handle->value : number->value, number->unit)
               : fmt::format("Point {}", handle.point + 1);
    pen.items.push_back(
        {number ? "handle:" + number->name : fmt::format("handle:point-{}", handle.point + 1),
         "view",
         {at.x() - 4, at.y() - 4, 8, 8},
         words});
    const bool is_near = std::hypot(mouse.x - at.x(), mouse.y - at.y()) < pen.px(10);
    if (held || (is_near && !view.held_handle && !ImGui::GetIO().WantCaptureMouse)) hovered = words;
  }
  list.PopClipRect();
  if (!hovered.empty()) beside_mouse(hovered);
}

void Panels::Drawing::cut_panel() {
  const Theme& theme = panels.theme_;
  DrawnCut& drawn = view.drawn_cut;
  begin_panel(pen, "cut", layout.tool);
  heading(pen, "Draw a cut",
          drawn.part ? display_name(input.scene.parts[*drawn.part].name) : std::string());
  ImGui::PushTextWrapPos(0);
  text(
      theme.small, palette().text_dim,
      "Click points along the cut; the first and the last may lie beside the bone. The saw follows "
      "the view of the first click. Points can be dragged.");
  ImGui::PopTextWrapPos();
  cut_numbers(drawn);
  cut_findings();
  cut_buttons(drawn);
  end_panel();
}

void Panels::Drawing::cut_numbers(DrawnCut& drawn) {
  const auto row = [&](const char* name, const char* label, double& value, double high,
                       const char* help) {
    constexpr float number_width = 84;
    ImGui::AlignTextToFramePadding();
    text(panels.theme_.regular, palette().text, label);
    ImGui::SameLine(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x -
                    pen.px(number_width));
    ImGui::SetNextItemWidth(pen.px(number_width));
    double entered = value;
    if (number_field(pen, name, entered, "%.1f mm", panels.form_.number))
      value = std::clamp(entered, 0.0, high);
    tooltip(pen, help);
  };
  row("cut-kerf", "Kerf", drawn.kerf_mm, largest_kerf_mm, "Thickness of the saw cut");
  row("cut-depth", "Depth", drawn.depth_mm, largest_depth_mm,
      "Below the deepest point; 0 cuts through the first wall of bone");
}

void Panels::Drawing::cut_findings() {
  const auto& preview = input.scene.plan.preview;
  if (!preview) return;
  ImGui::PushTextWrapPos(0);
  if (!preview->problem.empty()) {
    text(panels.theme_.small, palette().warning, preview->problem);
    pen.mark("cut-problem", preview->problem);
  }
  for (const std::string& finding : preview->findings)
    text(panels.theme_.small, preview->warns ? palette().warning : palette().text, finding);
  if (!preview->findings.empty()) pen.mark("cut-findings", preview->findings.front());
  ImGui::PopTextWrapPos();
}

void Panels::Drawing::cut_buttons(DrawnCut& drawn) {
  const float whole = ImGui::GetContentRegionAvail().x, high = pen.px(26);
  const auto edit = drawn_cut_edit(input.scene, view);
  ImGui::BeginDisabled(!edit);
  if (word_button(pen, "cut-add", "Add to the plan", {whole, high}, edit.has_value()))
    panels.accept_cut(input.scene, view);
  ImGui::EndDisabled();
  tooltip(pen, "The smaller piece becomes a segment. Enter");
  const ImVec2 half = {width_of_each(pen, whole, 2), high};
  ImGui::BeginDisabled(drawn.points.empty());
  if (word_button(pen, "cut-back", "Remove point", half, false)) drawn.points.pop_back();
  ImGui::SameLine(0, pen.px(button_gap));
  if (word_button(pen, "cut-clear", "Clear", half, false)) drawn.points.clear();
  ImGui::EndDisabled();
}

}  // namespace condyle
