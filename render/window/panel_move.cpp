#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <cmath>

#include "render/window/handles.h"
#include "render/window/panels_drawing.h"

namespace condyle {
namespace {

using Eigen::Vector2d;

// Left, back, up: colours that colour-blind people can tell apart, and letters.
constexpr std::array axis_colours = {colour::rgb(0xe8713a), colour::rgb(0x2fbf93),
                                     colour::rgb(0x56b4e9)};
constexpr std::array axis_letters = {"L", "P", "S"};
constexpr std::array shift_names = {"Left", "Back", "Up"};
constexpr std::array turn_names = {"Pitch", "Roll", "Yaw"};
constexpr std::array turn_tips = {
    "About the axis to the patient's left: positive lowers the chin's front, deg",
    "About the axis to the back, deg", "About the upward axis: positive turns to the left, deg"};

ImVec2 point(const Vector2d& p) { return {static_cast<float>(p.x()), static_cast<float>(p.y())}; }

/// A number with its name and unit in a column of its own. gives: true while it changes.
bool number_field(Pen& pen, const std::string& name, const char* label, const char* format,
                  double& value) {
  text(pen.theme.small, palette().text_dim, label);
  ImGui::SetNextItemWidth(pen.px(92));
  const bool changed =
      ImGui::InputDouble(("##" + name).c_str(), &value, 0, 0, format,
                         ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_EnterReturnsTrue |
                             ImGuiInputTextFlags_CharsScientific);
  pen.mark(name);
  return changed;
}

}  // namespace

void Panels::Drawing::moving() {
  const Theme& theme = panels.theme_;
  if (input.scene.bodies.empty() || !input.frame) return;
  view.chosen = std::min(view.chosen, input.scene.bodies.size() - 1);
  const MovableBody& body = input.scene.bodies[view.chosen];
  const Pose now = pose_of(input.scene.parts, body.part, input.frame->poses());

  // The handles, on the picture.
  HandleView handle_view{input.camera, layout.view, now * body.center};
  handle_view.arrow_px *= theme.scale;
  handle_view.ring_px *= theme.scale;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const auto lit = grip_at(handle_view, {mouse.x, mouse.y}, pen.px(9));
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ViewRect& r = layout.view;
  list.PushClipRect({static_cast<float>(r.x), static_cast<float>(r.y)},
                    {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  for (const Handle& handle : handles(handle_view)) {
    const auto axis = static_cast<std::size_t>((static_cast<int>(handle.grip) - 1) % 3);
    const ImU32 tint = lit == handle.grip ? colour::rgb(0xffffff) : axis_colours[axis];
    std::vector<ImVec2> line;
    for (const auto& p : handle.line) line.push_back(point(p));
    list.AddPolyline(line.data(), static_cast<int>(line.size()), colour::rgb(0x0f1215, 150), 0,
                     pen.px(4.5f));
    list.AddPolyline(line.data(), static_cast<int>(line.size()), tint, 0, pen.px(2.2f));
    const ImVec2 tip = line[line.size() == 2 ? 1 : 6];
    pen.items.push_back(
        {fmt::format("handle:{}{}", line.size() == 2 ? "" : "turn-", axis_letters[axis]),
         "handles",
         {tip.x - 3, tip.y - 3, 6, 6}});
    if (line.size() != 2) continue;
    list.AddCircleFilled(tip, pen.px(9), tint, 24);
    const ImVec2 extent =
        theme.small->CalcTextSizeA(theme.small->FontSize, 1e6f, 0, axis_letters[axis]);
    list.AddText(theme.small, theme.small->FontSize, {tip.x - extent.x / 2, tip.y - extent.y / 2},
                 colour::rgb(0x0f1215), axis_letters[axis]);
  }
  list.PopClipRect();

  // Its place in numbers.
  const bool several = input.scene.bodies.size() > 1;
  const double wide = pen.px(224), high = pen.px((several ? 270 : 258) + (body.free ? 34 : 0)),
               margin = pen.px(12);
  if (r.width < 2 * wide || r.height < high + 2 * margin) return;
  begin_panel(pen, "move", {r.x + margin, r.y + margin, wide, high});
  heading(pen, "Move", "slides on contact");
  if (several) {
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    if (ImGui::BeginCombo("##body", display_name(input.scene.parts[body.part].name).c_str())) {
      for (std::size_t i = 0; i < input.scene.bodies.size(); ++i) {
        const std::string& name = input.scene.parts[input.scene.bodies[i].part].name;
        if (ImGui::Selectable(display_name(name).c_str(), i == view.chosen)) view.chosen = i;
        pen.mark("body:" + name);
      }
      ImGui::EndCombo();
    }
    pen.mark("body");
  } else {
    text(theme.regular, palette().text, display_name(input.scene.parts[body.part].name));
  }
  const Pose carrier = carrier_pose(body, input.frame->X_CM);
  const Pose reached = carrier.inverse() * now;
  const std::optional<Pose> hand = view.hands.of(body);
  Placement wanted = placement_of(hand.value_or(reached), body.center);
  // What rounds to nothing is shown without a sign.
  for (auto* numbers : {&wanted.shift_mm, &wanted.turn_deg})
    *numbers = (numbers->array().abs() < 5e-3).select(0, *numbers);
  bool edited = false;
  ImGui::Columns(2, "##fields", false);
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    edited |= number_field(pen, fmt::format("shift:{}", axis_letters[k]), shift_names[k], "%.2f mm",
                           wanted.shift_mm[i]);
    ImGui::NextColumn();
    edited |= number_field(pen, fmt::format("turn:{}", axis_letters[k]), turn_names[k],
                           "%.2f\u00b0", wanted.turn_deg[i]);
    tooltip(pen, turn_tips[k]);
    ImGui::NextColumn();
  }
  ImGui::Columns(1);
  if (edited && wanted.shift_mm.allFinite() && wanted.turn_deg.allFinite()) {
    if (!body.free) {
      view.playing = false;
      view.opening_mm.reset();
    }
    view.hands.of(body) = pose_at(wanted, body.center);
  }
  std::string state = body.free ? "as it was loaded" : "follows the motion";
  ImU32 tint = palette().text_dim;
  if (hand) {
    const double short_mm = (*hand * body.center - reached * body.center).norm();
    constexpr double held_mm = 0.05;
    state = short_mm > held_mm ? fmt::format("held by contact, {:.1f} mm short", short_mm)
                               : std::string("where it is wanted");
    tint = short_mm > held_mm ? palette().warning : palette().good;
  }
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(3));
  text(theme.small, tint, state);
  pen.mark("move-state");

  const float gap = pen.px(5);
  const ImVec2 size = {std::floor((ImGui::GetContentRegionAvail().x - 2 * gap) / 3), pen.px(26)};
  ImGui::BeginDisabled(!panels.history_.can_undo());
  if (word_button(pen, "undo", "Undo", size, false)) panels.run(Command::undo, input.scene, view);
  ImGui::EndDisabled();
  ImGui::SameLine(0, gap);
  ImGui::BeginDisabled(!panels.history_.can_redo());
  if (word_button(pen, "redo", "Redo", size, false)) panels.run(Command::redo, input.scene, view);
  ImGui::EndDisabled();
  ImGui::SameLine(0, gap);
  ImGui::BeginDisabled(!hand);
  if (word_button(pen, "put-back", "Put back", size, false)) {
    view.hands.of(body).reset();
  }
  ImGui::EndDisabled();
  tooltip(pen, body.free ? "To where it was loaded" : "The jaw follows the motion again");
  if (body.free) {
    if (word_button(pen, "let-go", "Let go onto the bone",
                    {ImGui::GetContentRegionAvail().x, size.y}, false))
      panels.wishes_.push_back(wish::LetGo{view.chosen});
    tooltip(pen, "It is pushed gently to the nearest bone, slides and turns until it lies still");
  }
  end_panel();
}

}  // namespace condyle
