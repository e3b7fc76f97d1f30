#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "render/window/panels_drawing.h"

namespace condyle {
namespace {

struct SkinChoice {
  const char* name;
  const char* label;
  double opacity;
};
constexpr SkinChoice skin_choices[] = {
    {"skin:off", "Off", 0}, {"skin:glass", "Glass", 0.35}, {"skin:full", "Full", 1}};

}  // namespace

void Panels::Drawing::parts() {
  const Theme& theme = panels.theme_;
  begin_panel(pen, "left", layout.left);

  // Skin first: it hides everything else.
  bool has_face = false;
  for (const Part& part : input.scene.parts) has_face |= part.role == Role::face;
  if (has_face) {
    heading(pen, "Skin", fmt::format("{:.0f} %", 100 * view.skin_opacity));
    slider(pen, "skin", view.skin_opacity, {.width = ImGui::GetContentRegionAvail().x});
    tooltip(pen, "How dense the skin is. Key K turns it on and off");
    const float gap = pen.px(5);
    const float wide = std::floor((ImGui::GetContentRegionAvail().x - 2 * gap) / 3);
    for (const SkinChoice& choice : skin_choices) {
      if (&choice != skin_choices) ImGui::SameLine(0, gap);
      if (word_button(pen, choice.name, choice.label, {wide, pen.px(26)},
                      std::abs(view.skin_opacity - choice.opacity) < 1e-6))
        view.skin_opacity = choice.opacity;
    }
  }

  heading(pen, "Parts", input.scene.parts.empty() ? "" : "opacity");
  const float row = ImGui::GetFrameHeight() + pen.px(3);
  const float notes_room = input.scene.notes.empty() ? 0 : pen.px(96);
  const float settings_room =
      pen.px(34) + static_cast<float>(input.scene.distance_colours ? 4 : 3) * row;
  const float most =
      std::max(2 * row, ImGui::GetContentRegionAvail().y - settings_room - notes_room);
  const float wanted = row * static_cast<float>(input.scene.parts.size());
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 3));
  ImGui::BeginChild("part-list", {0, std::min(wanted, most)});
  for (std::size_t i = 0; i < input.scene.parts.size(); ++i) {
    const Part& part = input.scene.parts[i];
    PartView& one = view.parts[i];
    const float bar = pen.px(66), end = ImGui::GetContentRegionAvail().x;
    const float room = end - bar - pen.px(15 + 8 + 8);
    const std::string label = fitted(theme.regular, display_name(part.name), room);
    const float y = ImGui::GetCursorPosY();
    tick_box(pen, ("show:" + part.name).c_str(), label.c_str(), one.shown);
    if (label.ends_with("...")) tooltip(pen, part.name.c_str());
    if (part.role == Role::face) continue;  // its opacity is the skin's
    ImGui::SameLine();
    ImGui::SetCursorPos({end - bar, y});
    ImGui::BeginDisabled(!one.shown);
    slider(pen, ("opacity:" + part.name).c_str(), one.opacity, {.width = bar});
    tooltip(pen, fmt::format("{:.0f} %", 100 * one.opacity).c_str());
    ImGui::EndDisabled();
  }
  ImGui::EndChild();

  heading(pen, "Settings");
  tick_box(pen, "obey-contact", "Stop at contact", view.obey_contact);
  tooltip(pen, "On: bones cannot pass through each other. Off: the motion is played as it is");
  tick_box(pen, "mark-contacts", "Mark contacts", view.mark_contacts);
  tooltip(pen, "Points where bones or teeth touch");
  if (input.scene.distance_colours) {
    bool on = view.distances;
    if (tick_box(pen, "distances", "Distances", on))
      panels.run(Command::toggle_distances, input.scene, view);
    tooltip(pen,
            "Bones and teeth coloured by how far they are from what they may meet. Takes the skin "
            "away: it would hide them. Key D");
  }
  tick_box(pen, "shadows", "Shadows", view.shadows);
  ImGui::PopStyleVar();

  if (!input.scene.notes.empty()) {
    heading(pen, "Notes");
    ImGui::BeginChild("notes", {0, std::max(pen.px(20), ImGui::GetContentRegionAvail().y)});
    ImGui::PushTextWrapPos(0);
    for (const std::string& note : input.scene.notes) text(theme.small, palette().text_dim, note);
    ImGui::PopTextWrapPos();
    ImGui::EndChild();
  }
  end_panel();
}

}  // namespace condyle
