#include <imgui.h>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

constexpr double glass = 0.35, opaque = 1;

}  // namespace

/// What can be done with the clicked part.
void Panels::Drawing::part_menu() {
  auto& menu = panels.form_.part_menu;
  if (!menu) return;
  if (menu->part() >= input.scene.parts.size()) return menu.reset();
  ImGui::SetNextWindowPos({static_cast<float>(menu->x), static_cast<float>(menu->y)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, pen.px(10, 8));
  ImGui::Begin("##part-menu", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize);
  if (!menu->shown) ImGui::SetWindowFocus();
  const bool leaves = menu->shown && !ImGui::IsWindowHovered() &&
                      (ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1));
  menu->shown = true;
  const Part& part = input.scene.parts[menu->part()];
  text(panels.theme_.bold, palette().text, display_name(part.name));
  ImGui::Separator();
  const bool looked = part_menu_looks(menu->part());
  ImGui::Separator();
  const bool done = part_menu_tools(*menu) || looked || leaves;
  const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  pen.items.push_back({"part-menu", "", {at.x, at.y, size.x, size.y}, display_name(part.name)});
  ImGui::End();
  ImGui::PopStyleVar();
  if (done) menu.reset();
}

bool Panels::Drawing::menu_row(const char* name, const char* label, bool enabled) {
  const bool chosen = ImGui::Selectable(label, false, enabled ? 0 : ImGuiSelectableFlags_Disabled);
  pen.mark(std::string("menu:") + name, label);
  return chosen;
}

/// Returns whether something was chosen, as does the next.
bool Panels::Drawing::part_menu_looks(std::size_t which) {
  PartView& drawn = view.parts[which];
  // The skin has an opacity of its own, which everything else of the window uses.
  const bool is_face = input.scene.parts[which].role == Role::face;
  double& opacity = is_face ? view.skin_opacity : drawn.opacity;
  const bool hide = menu_row("hide", "Hide");
  if (hide) drawn.shown = false;
  const bool solid = opacity > 0.5, glass_chosen = menu_row("glass", solid ? "Glass" : "Opaque");
  if (glass_chosen) opacity = solid ? glass : opaque;
  const bool alone = menu_row("alone", "Show alone");
  if (alone)
    for (std::size_t i = 0; i < view.parts.size(); ++i) view.parts[i].shown = i == which;
  bool any_hidden = false;
  for (const PartView& each : view.parts) any_hidden |= !each.shown;
  const bool all = menu_row("show-all", "Show all parts", any_hidden);
  if (all)
    for (PartView& each : view.parts) each.shown = true;
  const bool mirrored = view.look.mirrored == input.scene.parts[which].name;
  const bool mirror = menu_row("mirror", mirrored ? "Hide the mirror image" : "Mirror image",
                               mirrored || (input.scene.has_midsagittal_plane && !is_face));
  if (mirror) view.look.mirrored = mirrored ? "" : input.scene.parts[which].name;
  const bool other = !view.look.mirrored.empty() && !mirrored && !mirror;
  const bool unmirror = other && menu_row("mirror-off", "Hide the other mirror image");
  if (unmirror) view.look.mirrored.clear();
  const bool focus = menu_row("focus", "Focus");
  if (focus) commands.push_back(Command::focus_selected);
  return hide || glass_chosen || alone || all || mirror || unmirror || focus;
}

bool Panels::Drawing::part_menu_tools(const PartMenu& menu) {
  const Part& part = input.scene.parts[menu.part()];
  const bool measure = menu_row("measure", "Measure from here");
  if (measure) {
    view.tool = Tool::measure;
    view.measured = {menu.point};
  }
  const bool cut = menu_row("cut", "Draw a cut", can_be_cut(part));
  if (cut) {
    view.tool = Tool::cut;
    view.drawn_cut.part = menu.part();
    view.drawn_cut.points.clear();
  }
  const auto body = movable_body_of(input.scene.bodies, input.scene.parts, menu.part());
  const bool move = menu_row("move", "Move", body.has_value());
  if (move) {
    view.tool = Tool::move;
    view.chosen = *body;
  }
  return measure || cut || move;
}

}  // namespace condyle
