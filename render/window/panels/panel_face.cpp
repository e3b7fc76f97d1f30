#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

ExpressionLevel level_of(const std::vector<ExpressionLevel>& levels, const std::string& name) {
  const auto found = std::find_if(levels.begin(), levels.end(),
                                  [&](const auto& level) { return level.name == name; });
  return found == levels.end() ? ExpressionLevel{.name = name} : *found;
}

/// Those that are zero on both sides are left out.
void set_level(std::vector<ExpressionLevel>& levels, const ExpressionLevel& to) {
  const auto found = std::find_if(levels.begin(), levels.end(),
                                  [&](const auto& level) { return level.name == to.name; });
  const bool excites = to.left > 0 || to.right > 0;
  if (found != levels.end() && excites)
    *found = to;
  else if (found != levels.end())
    levels.erase(found);
  else if (excites)
    levels.push_back(to);
}

}  // namespace

/// The face's expression, which is added to that of the motion.
void Panels::Drawing::face() {
  heading(pen, "Expression", "patient's right and left");
  if (input.scene.expressions.empty()) {
    ImGui::TextWrapped(
        "This patient has no muscles of the face: they need soft tissue and the landmarks of their "
        "attachments");
    return;
  }
  tick_box(pen, "both-sides", "Both sides at once", panels.form_.both_sides);
  const float foot = pen.px(34);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 1));
  ImGui::BeginChild("expression-list",
                    {0, std::max(pen.px(60), ImGui::GetContentRegionAvail().y - foot)});
  for (const TreeItem& item : input.scene.expressions) expression_row(item);
  ImGui::EndChild();
  ImGui::PopStyleVar();
  ImGui::BeginDisabled(view.expression.empty());
  if (word_button(pen, "expression-relax", "Relax the face",
                  {ImGui::GetContentRegionAvail().x, pen.px(26)}, false))
    view.expression.clear();
  ImGui::EndDisabled();
  tooltip(pen, "All sliders to 0; the expressions of the motion stay");
}

/// A slider for each side; the patient's right is at the left, as in a view from the front.
void Panels::Drawing::expression_row(const TreeItem& item) {
  ExpressionLevel level = level_of(view.expression, item.name);
  const auto percent = [](double value) { return std::lround(100 * value); };
  text(pen.theme.regular, level.left > 0 || level.right > 0 ? palette().text : palette().text_dim,
       item.label);
  ImGui::SameLine();
  const std::string numbers = fmt::format("{} %  {} %", percent(level.right), percent(level.left));
  text_right(pen.theme.regular, palette().text, numbers);
  pen.mark("number:" + item.name, numbers);
  const float gap = pen.px(8), width = (ImGui::GetContentRegionAvail().x - gap) / 2;
  for (const bool left : {false, true}) {
    if (left) ImGui::SameLine(0, gap);
    double& value = left ? level.left : level.right;
    const std::string name = "expression:" + item.name + (left ? ":left" : ":right");
    if (slider(pen, name.c_str(), value, {.low = 0, .high = 1, .width = width, .typed = 100})) {
      if (panels.form_.both_sides) level.left = level.right = value;
      set_level(view.expression, level);
    }
    tooltip(pen, left ? "Left side. Ctrl+click to type a percentage"
                      : "Right side. Ctrl+click to type a percentage");
  }
}

}  // namespace condyle
