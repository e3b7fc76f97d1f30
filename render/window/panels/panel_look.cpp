#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

/// A slider below its name and number.
void named_slider(Pen& pen, const char* item, const char* label, const std::string& number,
                  double& value, const SliderLook& look) {
  text(pen.theme.small, palette().text_dim, label);
  ImGui::SameLine();
  text_right(pen.theme.small, palette().text, number);
  pen.mark(std::string("number:") + item, number);
  slider(pen, item, value, look);
}

/// Extent of the box along the axis of that side.
double extent_mm(const Eigen::AlignedBox3d& box, char side) {
  const Eigen::Vector3d size = box.sizes();
  return side == 'L' || side == 'R' ? size.x() : side == 'A' || side == 'P' ? size.y() : size.z();
}

constexpr float button_high = 24;  // at scale 1

ImVec2 button_size(const Pen& pen, int count) {
  return {width_of_each(pen, ImGui::GetContentRegionAvail().x, count), pen.px(button_high)};
}

}  // namespace

void Panels::Drawing::look() {
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(6));
  ImGui::BeginChild("look-list", {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 3));
  look_cuts();
  look_comparison();
  look_overlays();
  look_panel_size();
  ImGui::PopStyleVar();
  ImGui::EndChild();
}

void Panels::Drawing::look_cuts() {
  Look& look = view.look;
  heading(pen, "Cut open");
  tick_box(pen, "clip", "Clipping plane", look.clip);
  tooltip(pen, "Takes everything away on one side of a plane; cut faces are closed");
  if (look.clip) {
    const ImVec2 size = button_size(pen, 6);
    for (const char side : {'L', 'R', 'A', 'P', 'S', 'I'}) {
      if (side != 'L') ImGui::SameLine(0, pen.px(button_gap));
      const char label[2] = {side, 0};
      if (word_button(pen, (std::string("clip-from:") + side).c_str(), label, size,
                      look.clip_from == side))
        look.clip_from = side;
    }
    tooltip(pen, "The side that is removed");
    const double deep_mm = look.clip_fraction * extent_mm(input.box, look.clip_from);
    named_slider(pen, "clip-depth", "Depth",
                 fmt::format("{:.0f} mm, {:.0f} %", deep_mm, 100 * look.clip_fraction),
                 look.clip_fraction, {.width = ImGui::GetContentRegionAvail().x, .typed = 100});
    tooltip(pen, "Depth from that side, in mm and as a percentage of the patient's extent");
    const bool has_face = std::any_of(input.scene.parts.begin(), input.scene.parts.end(),
                                      [](const Part& part) { return part.role == Role::face; });
    if (has_face) {
      ImGui::SetCursorPosX(ImGui::GetCursorPosX() + pen.px(16));
      tick_box(pen, "clip-skin", "only the skin", look.clip_skin);
      tooltip(pen, "Bones and teeth are not cut");
    }
  }
  tick_box(pen, "cut-away", "Window in the skin", look.cut_away);
  tooltip(pen, "Leaves the skin out in a ball around a joint or the mouth");
  if (look.cut_away) {
    constexpr std::array<std::pair<Look::Window, const char*>, 3> places = {
        {{Look::Window::left_joint, "Left"},
         {Look::Window::right_joint, "Right"},
         {Look::Window::mouth, "Mouth"}}};
    const ImVec2 size = button_size(pen, 3);
    for (const auto& [place, label] : places) {
      if (place != Look::Window::left_joint) ImGui::SameLine(0, pen.px(button_gap));
      if (word_button(pen, (std::string("cut-at:") + label).c_str(), label, size,
                      look.cut_at == place))
        look.cut_at = place;
    }
    named_slider(pen, "cut-radius", "Radius", fmt::format("{:.0f} mm", look.cut_radius_mm),
                 look.cut_radius_mm,
                 {.low = 10, .high = 90, .width = ImGui::GetContentRegionAvail().x});
  }
}

void Panels::Drawing::look_comparison() {
  Look& look = view.look;
  heading(pen, "Compare");
  tick_box(pen, "ghost", "Ghost of the rest state", look.ghost);
  tooltip(pen, "What has moved, as it was at rest, in blue glass");
  tick_box(pen, "wipe", "Two states with a wipe", look.wipe);
  tooltip(pen,
          "At the left the kept state (at first: before the operation, or rest), at the right the "
          "present one");
  if (look.wipe) {
    named_slider(pen, "wipe-at", "Place, from the left",
                 fmt::format("{:.0f} %", 100 * look.wipe_at), look.wipe_at,
                 {.width = ImGui::GetContentRegionAvail().x, .filled = false, .typed = 100});
    if (word_button(pen, "wipe-keep", "Keep the present state", button_size(pen, 1), false))
      commands.push_back(Command::keep_state);
  }
}

void Panels::Drawing::look_overlays() {
  Look& look = view.look;
  heading(pen, "Show");
  look_distances();
  const bool has_tissue = input.frame && !input.frame->tissue.nodes.empty();
  if (has_tissue) look_displacement();
  tick_box(pen, "paths", "Paths of incisor and condyles", look.paths);
  tooltip(pen, "Paths of the lower incisal point and of the condyles over the whole motion");
  look_muscles(has_tissue);
  if (has_tissue) look_springs();
  tick_box(pen, "wireframe", "Triangles", look.wireframe);
  tick_box(pen, "axes", "Axes", look.axes);
  tooltip(pen,
          "Through both condyles (yellow); about which the jaw has turned from rest (purple); the "
          "patient's left, back and up (orange, green, blue)");
  tick_box(pen, "scale-bar", "Scale bar", look.scale_bar);
  tick_box(pen, "letters", "Orientation letters", look.letters);
  tooltip(pen, "L left, R right, A front, P back, S up, I down: the patient's");
  tick_box(pen, "shadows", "Shadows", view.shadows);
  tick_box(pen, "folds", "Folds of the skin", look.folds);
  tooltip(pen,
          "Where the skin is compressed; also the hollows of the cheeks and the pad under the chin "
          "of an open mouth. In the picture alone, not in measures or exports");
  tick_box(pen, "life", "Life (look only)", look.life);
  tooltip(pen,
          "An opaque face blinks, looks around and breathes while the motion plays, and the head "
          "extends as the jaw opens; in the picture alone, never in measures or exports");
}

void Panels::Drawing::look_distances() {
  if (!input.scene.distance_colours) return;
  bool on = view.distances;
  if (tick_box(pen, "distances", "Distances", on))
    panels.run(Command::toggle_distances, input.scene, view);
  tooltip(pen,
          "Bones and teeth coloured by how far they are from what they may meet. Takes the skin "
          "away, which would hide them, until they are off again. Key D");
  if (view.distances) {
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + pen.px(16));
    tick_box(pen, "patches", "only where they touch", view.look.patches);
    tooltip(pen, "Contact patches: colours up to the width of contact, bone beyond");
  }
}

void Panels::Drawing::look_displacement() {
  Look& look = view.look;
  if (tick_box(pen, "displacement", "Skin displacement", look.displacement) && look.displacement) {
    view.distances = false;  // one scale of colours at a time
    view.return_skin();
    if (view.skin_opacity < 0.5) view.skin_opacity = 1;
  }
  tooltip(pen, "The skin coloured by the distance of each point from its rest position");
}

void Panels::Drawing::look_muscles(bool has_tissue) {
  Look& look = view.look;
  if (has_tissue) {
    tick_box(pen, "facial-muscles", "Facial muscles", look.facial_muscles);
    tooltip(pen, "Muscles of expression in the soft tissue. Thin the skin to see them");
  }
  if (input.scene.muscles.empty()) return;
  tick_box(pen, "muscle-labels", "Names of muscles", look.muscle_labels);
  tooltip(pen, "At the jaw muscles that are shown, on the near side");
}

void Panels::Drawing::look_springs() {
  Look& look = view.look;
  tick_box(pen, "springs", "Springs of the soft tissue", look.springs);
  tooltip(pen,
          "The network that deforms the face: blue shortened, red stretched. Thin the skin to "
          "see it");
  tick_box(pen, "prisms", "Prisms of the soft tissue", look.prisms);
  tooltip(pen, "The cells whose volume the tissue keeps. Thin the skin to see them");
  tick_box(pen, "bone-springs", "Springs to the bone", look.bone_springs);
  tooltip(pen,
          "Where the tissue is attached: to the mandible orange, to the skull blue. Thin the "
          "skin to see them");
}

void Panels::Drawing::look_panel_size() {
  heading(pen, "Panels", fmt::format("{:.0f} %", 100 * pen.theme.scale));
  constexpr std::array<std::pair<const char*, Command>, 3> sizes = {
      {{"Smaller", Command::smaller_panels},
       {"Reset", Command::default_panels},
       {"Larger", Command::larger_panels}}};
  const ImVec2 size = button_size(pen, 3);
  for (const auto& [label, command] : sizes) {
    if (command != sizes.front().second) ImGui::SameLine(0, pen.px(button_gap));
    if (word_button(pen, (std::string("panels:") + label).c_str(), label, size, false))
      commands.push_back(command);
    tooltip(pen, "Size of panels and text. Ctrl+-, Ctrl+0, Ctrl+=");
  }
}

}  // namespace condyle
