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
  constexpr const char* name = "##part-menu";
  if (!menu->shown) {
    if (ImGui::IsAnyMouseDown()) return;  // a press that the panels have yet to see would close it
    ImGui::OpenPopup(name);
    ImGui::SetNextWindowPos({static_cast<float>(menu->x), static_cast<float>(menu->y)});
    menu->shown = true;
  }
  if (!ImGui::BeginPopup(name)) return menu.reset();
  const Part& part = input.scene.parts[menu->part()];
  text(panels.theme_.bold, palette().text, display_name(part.name));
  ImGui::Separator();
  part_menu_looks(menu->part());
  ImGui::Separator();
  part_menu_tools(*menu);
  const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  pen.items.push_back({"part-menu", "", {at.x, at.y, size.x, size.y}, display_name(part.name)});
  ImGui::EndPopup();
}

bool Panels::Drawing::menu_row(const char* name, const char* label, bool enabled) {
  const bool chosen = ImGui::Selectable(label, false, enabled ? 0 : ImGuiSelectableFlags_Disabled);
  pen.mark(std::string("menu:") + name, label);
  return chosen;
}

void Panels::Drawing::part_menu_looks(std::size_t which) {
  PartView& drawn = view.parts[which];
  // The skin has an opacity of its own, which everything else of the window uses.
  const bool is_face = input.scene.parts[which].role == Role::face;
  double& opacity = is_face ? view.skin_opacity : drawn.opacity;
  if (menu_row("hide", "Hide")) drawn.shown = false;
  const bool solid = opacity > 0.5;
  if (menu_row("glass", solid ? "Glass" : "Opaque")) opacity = solid ? glass : opaque;
  if (menu_row("alone", "Show alone"))
    for (std::size_t i = 0; i < view.parts.size(); ++i) view.parts[i].shown = i == which;
  bool any_hidden = false;
  for (const PartView& each : view.parts) any_hidden |= !each.shown;
  if (menu_row("show-all", "Show all parts", any_hidden))
    for (PartView& each : view.parts) each.shown = true;
  if (menu_row("focus", "Focus")) commands.push_back(Command::focus_selected);
}

void Panels::Drawing::part_menu_tools(const PartMenu& menu) {
  const Part& part = input.scene.parts[menu.part()];
  if (menu_row("measure", "Measure from here")) {
    view.tool = Tool::measure;
    view.measured = {menu.point};
  }
  const bool is_bone = collides(part.role) && !is_teeth(part.role) && part.role != Role::transplant;
  if (menu_row("cut", "Draw a cut", is_bone)) {
    view.tool = Tool::cut;
    view.drawn_cut.part = menu.part();
    view.drawn_cut.points.clear();
  }
  const auto body = movable_body_of(input.scene.bodies, input.scene.parts, menu.part());
  if (menu_row("move", "Move", body.has_value())) {
    view.tool = Tool::move;
    view.chosen = *body;
  }
}

}  // namespace condyle
