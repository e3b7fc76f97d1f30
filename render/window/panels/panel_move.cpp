#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <cmath>
#include <numbers>

#include "render/window/input/gizmos.h"
#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

using Eigen::Vector2d;

// Left, back, up: colours that colour-blind people can distinguish, and letters.
constexpr std::array axis_colours = {colour::rgb(0xe8713a), colour::rgb(0x2fbf93),
                                     colour::rgb(0x56b4e9)};
constexpr std::array axis_letters = {"L", "P", "S"};
constexpr std::array shift_names = {"Left", "Back", "Up"};
constexpr std::array turn_names = {"Pitch", "Roll", "Yaw"};
constexpr std::array turn_tips = {
    "About the axis to the patient's left: positive lowers the chin's front",
    "About the axis to the back", "About the upward axis: positive turns to the left"};
// Columns of the table of numbers, at scale 1.
constexpr float target_column = 58, target_width = 92;

ImVec2 point(const Vector2d& p) { return {static_cast<float>(p.x()), static_cast<float>(p.y())}; }

/// Texts about a body: what moves with it, and the effects of resetting and releasing it.
struct BodyWords {
  const char *goes_along, *reset, *release, *release_tip;
};
BodyWords words_of(const MovableBody& body) {
  if (body.roams())
    return {"alone", "To where it was loaded", "Release onto the bone",
            "It is pushed gently to the nearest bone that it does not touch yet, slides and turns "
            "until it lies still; all other bone stays. Moving anything meanwhile, the timeline or "
            "another motion end this"};
  if (body.is_skull())
    return {
        "the lower jaw stays",
        "To where it was loaded; a jaw that stayed in the picture is as before the skull was "
        "moved",
        "Release to the muscles",
        "The lower jaw stays in the picture: joints, the jaw's weight and muscles (their tone at "
        "rest, or what a motion by muscles does at this moment) draw skull and jaw together "
        "until both are still, teeth on teeth, on other bone or apart. Moving anything "
        "meanwhile, the timeline or another motion end this"};
  return {"with its teeth", "The jaw follows the motion again", "Release to the muscles",
          "Joints draw the condyles in; weight and muscles (their tone at rest, or what a motion "
          "by muscles does at this moment) move the jaw until it hangs still or lies on its teeth "
          "or other bone. Moving anything meanwhile, the timeline or another motion end this"};
}

/// Effect of a handle: "Mandible: to the left or right, with its teeth".
std::string words_of(Grip grip, const MovableBody& body, const std::string& name) {
  constexpr std::array directions = {"to the left or right",
                                     "forward or back",
                                     "up or down",
                                     "about the axis to the left",
                                     "about the axis to the back",
                                     "about the axis upward"};
  return fmt::format("{}: {}, {}", display_name(name),
                     directions[static_cast<std::size_t>(static_cast<int>(grip) - 1)],
                     words_of(body).goes_along);
}

constexpr double held_mm = 0.05,
                 held_deg = 0.05;  // farther from the target: contact holds the body

/// "-1.25 mm"; values that round to zero have no sign.
std::string number_words(double value, const char* unit) {
  return fmt::format("{:.2f}{}", std::abs(value) < 5e-3 ? 0 : value, unit);
}

/// One row of the table: a name, the target, which can be edited, and the value reached. `draft`:
/// text not yet entered. Returns true when another target was entered.
bool target_row(Pen& pen, std::optional<NumberEntry>& draft, const std::string& name,
                const char* label, const char* unit, double& target, double reached,
                double held_from) {
  const std::string shown = number_words(target, unit);
  ImGui::AlignTextToFramePadding();
  text(pen.theme.small, palette().text_dim, label);
  ImGui::SameLine(pen.px(target_column));
  ImGui::SetNextItemWidth(pen.px(target_width));
  // The number shown is rounded: entering it unchanged changes nothing.
  double entered = std::stod(shown);
  const bool another =
      number_field(pen, name.c_str(), entered, (std::string("%.2f") + unit).c_str(), draft);
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  const std::string words = number_words(reached, unit);
  const bool held = std::abs(target - reached) > held_from;
  text_right(pen.theme.regular, held ? palette().warning : palette().text, words);
  pen.mark("reached:" + name, words);
  if (another) target = entered;
  return another;
}

}  // namespace

void Panels::Drawing::moving() {
  if (input.scene.bodies.empty() || !input.frame) return;
  view.chosen = std::min(view.chosen, input.scene.bodies.size() - 1);
  const MovableBody& body = input.scene.bodies[view.chosen];
  gizmo(body);
  if (layout.tool.width <= 0) return;
  begin_panel(pen, "move", layout.tool);
  heading(pen, "Move", view.obey_contact ? "slides on contact" : "Stop at contact is off");
  body_choice(body);
  if (!body.point.empty()) text(panels.theme_.small, palette().text_dim, "about the " + body.point);
  body_placement(body);
  body_buttons(body);
  end_panel();
}

/// The handles, on the picture.
void Panels::Drawing::gizmo(const MovableBody& body) {
  const Theme& theme = panels.theme_;
  GizmoView gizmo_view{input.camera, layout.view, input.frame->poses[body.body] * body.center,
                       body.is_skull() ? body.axes : input.frame->poses[body.parent].R * body.axes};
  gizmo_view.arrow_px *= theme.scale;
  gizmo_view.ring_px *= theme.scale;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const auto lit = grip_at(gizmo_view, {mouse.x, mouse.y}, pen.px(9));
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ViewRect& r = layout.view;
  list.PushClipRect({static_cast<float>(r.x), static_cast<float>(r.y)},
                    {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  for (const GizmoHandle& handle : gizmo_handles(gizmo_view)) {
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
  if (lit && input.hover_text.empty() && !ImGui::GetIO().WantCaptureMouse &&
      !ImGui::IsAnyMouseDown())
    beside_mouse(words_of(*lit, body, input.scene.parts[body.part].name));
}

void Panels::Drawing::body_choice(const MovableBody& body) {
  const std::string chosen = display_name(input.scene.parts[body.part].name);
  if (input.scene.bodies.size() == 1) {
    text(panels.theme_.regular, palette().text, chosen);
    return;
  }
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  if (ImGui::BeginCombo("##body", chosen.c_str())) {
    for (std::size_t i = 0; i < input.scene.bodies.size(); ++i) {
      const std::string& name = input.scene.parts[input.scene.bodies[i].part].name;
      if (ImGui::Selectable(display_name(name).c_str(), i == view.chosen)) view.chosen = i;
      pen.mark("body:" + name);
    }
    ImGui::EndCombo();
  }
  pen.mark("body");
  tooltip(
      pen,
      "The body that the handles and numbers move; in the picture, press on a jaw or a free part "
      "to select it. The skull with the upper jaw moves by its handles while it is selected "
      "here: the lower jaw stays in place in the picture");
}

/// The body's place in numbers: its target, which can be edited, and the pose reached.
void Panels::Drawing::body_placement(const MovableBody& body) {
  const Theme& theme = panels.theme_;
  const Pose& X_CM = input.frame->poses[view.hands.jaw];
  const Pose reached =
      body.is_skull() ? view.hands.X_RC(X_CM) : pose_in(body.parent, body.body, input.frame->poses);
  const std::optional<Pose> hand = view.hands.of(body);
  Placement target = placement_of(hand.value_or(reached), body.center, body.axes);
  const Placement there = placement_of(reached, body.center, body.axes);
  Shortfall shortfall;
  if (hand)
    shortfall = {(target.shift_mm - there.shift_mm).norm(),
                 hand->R.angularDistance(reached.R) * 180 / std::numbers::pi};
  bool edited = false;
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, pen.px(8, 2));
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 3));
  text(theme.small, palette().text_faint, "");
  ImGui::SameLine(pen.px(target_column) + pen.px(8));
  text(theme.small, palette().text_faint, "target");
  ImGui::SameLine();
  text_right(theme.small, palette().text_faint, "reached");
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    edited |= target_row(pen, panels.form_.number, fmt::format("shift:{}", axis_letters[k]),
                         shift_names[k], " mm", target.shift_mm[i], there.shift_mm[i], held_mm);
  }
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    edited |= target_row(pen, panels.form_.number, fmt::format("turn:{}", axis_letters[k]),
                         turn_names[k], "\u00b0", target.turn_deg[i], there.turn_deg[i], held_deg);
    tooltip(pen, turn_tips[k]);
  }
  ImGui::PopStyleVar(2);
  if (edited) view.move(body, pose_at(target, body.center, body.axes), X_CM);
  body_state(body, hand.has_value(), shortfall);
}

void Panels::Drawing::body_state(const MovableBody& body, bool held, const Shortfall& shortfall) {
  std::string state = body.roams()      ? "as it was loaded"
                      : body.is_skull() ? "in its place"
                                        : "follows the motion";
  ImU32 tint = palette().text_dim;
  const bool turn = shortfall.turn_deg > held_deg;
  if (view.falling && !body.roams()) {
    state = "moving";
  } else if (turn || shortfall.shift_mm > held_mm) {
    state = turn ? fmt::format("held by contact, {:.1f} mm and {:.1f}\u00b0 short",
                               shortfall.shift_mm, shortfall.turn_deg)
                 : fmt::format("held by contact, {:.1f} mm short", shortfall.shift_mm);
    tint = palette().warning;
  } else if (held) {
    state = "at its target";
    tint = palette().good;
  }
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(3));
  text(panels.theme_.small, tint, state);
  pen.mark("move-state", state);
}

void Panels::Drawing::body_buttons(const MovableBody& body) {
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
  ImGui::BeginDisabled(!view.hands.of(body));
  if (word_button(pen, "reset-position", "Reset", size, false)) {
    view.hands.put_back(body, input.frame->poses[view.hands.jaw]);
  }
  ImGui::EndDisabled();
  const BodyWords words = words_of(body);
  tooltip(pen, words.reset);
  if (word_button(pen, "release-body", words.release, {ImGui::GetContentRegionAvail().x, size.y},
                  false))
    panels.requests_.push_back(request::Release{view.chosen});
  tooltip(pen, words.release_tip);
}

}  // namespace condyle
