#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <vector>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

/// One line of the tree.
struct TreeRow {
  std::string name;  // of its items
  std::string label;
  PartView* view;
  bool has_opacity = true;
  std::string tip = {};
  float bar = 66;  // width of its opacity, at scale 1
};

struct TreeGroup {
  const char* name;
  const char* label;
  const char* tip;
  std::vector<TreeRow> rows = {};
};

enum GroupNumber { bones, teeth, soft, free_parts, muscles, layers };

GroupNumber group_of(Role role) {
  switch (role) {
    case Role::upper_teeth:
    case Role::lower_teeth:
      return teeth;
    case Role::face:
    case Role::eyes:
    case Role::upper_gums:
    case Role::lower_gums:
    case Role::tongue:
      return soft;
    case Role::segment:
    case Role::transplant:
      return free_parts;
    default:
      return bones;
  }
}

/// Everything that can be shown, in groups; empty groups are omitted.
std::vector<TreeGroup> groups_of(const PanelInput& input, ViewState& view) {
  std::vector<TreeGroup> groups = {
      {"bones", "Bones", "Skull and jaws"},
      {"teeth", "Teeth", "Both arches"},
      {"soft", "Face and mouth", "Skin, eyes, gums, tongue. The opacity of the skin is set above"},
      {"free", "Segments", "Segments and transplants, which a hand can move (key M)"},
      {"muscles", "Muscles",
       "Bellies of the jaw muscles, coloured by group: dark at rest, bright when fully excited"},
      {"layers", "Soft tissue", "Its layers, each drawn by its outer surface"}};
  const WindowScene& scene = input.scene;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    const Part& part = scene.parts[i];
    groups[group_of(part.role)].rows.push_back(
        {part.name, display_name(part.name), &view.parts[i], part.role != Role::face});
  }
  const MuscleStates* states = input.frame ? &input.frame->muscles : nullptr;
  for (std::size_t i = 0; i < scene.muscles.size(); ++i) {
    std::string tip = scene.muscles[i].label;
    if (states && states->size() == scene.muscles.size())
      tip += fmt::format(": excited {:.0f} %, {:.0f} N", 100 * (*states)[i].excitation,
                         (*states)[i].force_N);
    const TreeItem& muscle = scene.muscles[i];
    groups[muscles].rows.push_back({"muscle:" + muscle.name,
                                    muscle.short_label.empty() ? muscle.label : muscle.short_label,
                                    &view.muscles[i], true, std::move(tip), 34});
  }
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    groups[layers].rows.push_back(
        {"layer:" + scene.layers[i].name, scene.layers[i].label, &view.layers[i]});
  std::erase_if(groups, [](const TreeGroup& group) { return group.rows.empty(); });
  return groups;
}

}  // namespace

bool Panels::Drawing::unfolded(const std::string& group) const {
  const auto& open = panels.open_groups_;
  return std::find(open.begin(), open.end(), group) != open.end();
}

void Panels::Drawing::fold_group(const std::string& group) {
  if (unfolded(group))
    std::erase(panels.open_groups_, group);
  else
    panels.open_groups_.push_back(group);
}

int Panels::Drawing::tree_rows() const {
  int rows = 0;
  for (const TreeGroup& group : groups_of(input, view))
    rows += 1 + (unfolded(group.name) ? static_cast<int>(group.rows.size()) : 0);
  return rows;
}

void Panels::Drawing::tree() {
  const Theme& theme = panels.theme_;
  const float indent = pen.px(15);
  for (TreeGroup& group : groups_of(input, view)) {
    const bool open = unfolded(group.name);
    if (fold(pen, std::string("group:") + group.name, open)) {
      fold_group(group.name);
      panels.to_sight_ = open ? "" : group.name;
    }
    if (open && panels.to_sight_ == group.name) {
      ImGui::SetScrollHereY(0);
      panels.to_sight_.clear();
    }
    tooltip(pen, open ? "Fold" : "Unfold");
    ImGui::SameLine(0, 0);
    bool any = std::any_of(group.rows.begin(), group.rows.end(),
                           [](const TreeRow& row) { return row.view->shown; });
    if (tick_box(pen, (std::string("show-all:") + group.name).c_str(), group.label, any))
      for (TreeRow& row : group.rows) row.view->shown = any;
    tooltip(pen, group.tip);
    if (!open) continue;
    for (TreeRow& row : group.rows) {
      const float bar = pen.px(row.bar);
      ImGui::SetCursorPosX(ImGui::GetCursorPosX() + indent);
      const float end = ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x;
      const float room =
          end - ImGui::GetCursorPosX() - (row.has_opacity ? bar + pen.px(8) : 0) - pen.px(15 + 8);
      const std::string label = fitted(theme.regular, row.label, room);
      const float y = ImGui::GetCursorPosY();
      tick_box(pen, ("show:" + row.name).c_str(), label.c_str(), row.view->shown);
      pen.items.back().words = label;
      if (!row.tip.empty() || label.ends_with("..."))
        tooltip(pen, (row.tip.empty() ? row.label : row.tip).c_str());
      if (!row.has_opacity) continue;
      ImGui::SameLine();
      ImGui::SetCursorPos({end - bar, y});
      ImGui::BeginDisabled(!row.view->shown);
      slider(pen, ("opacity:" + row.name).c_str(), row.view->opacity, {.width = bar, .typed = 100});
      tooltip(pen, fmt::format("{:.0f} %", 100 * row.view->opacity).c_str());
      ImGui::EndDisabled();
    }
  }
}

}  // namespace condyle
