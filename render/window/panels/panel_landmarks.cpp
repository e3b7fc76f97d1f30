#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "render/window/input/gizmos.h"
#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

constexpr float landmark_button_high = 26;  // at scale 1

}  // namespace

void Panels::Drawing::landmarks() {
  if (!input.frame) return;
  landmark_marks();
  if (layout.tool.width <= 0) return;
  begin_panel(pen, "landmarks", layout.tool);
  heading(pen, "Landmarks", fmt::format("{}", view.landmarks.size()));
  ImGui::PushTextWrapPos(0);
  text(panels.theme_.small, palette().text_dim,
       view.landmark ? "Click on the surface to place it."
                     : "Choose one, then click on the surface.");
  ImGui::PopTextWrapPos();
  landmark_list();
  landmark_edits();
  landmark_uses();
  end_panel();
}

/// On the picture: all as dots, with a name at the hovered and the selected one.
void Panels::Drawing::landmark_marks() {
  const Theme& theme = panels.theme_;
  const ViewRect& r = layout.view;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.PushClipRect({static_cast<float>(r.x), static_cast<float>(r.y)},
                    {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  constexpr ImU32 edge = colour::rgb(0x0f1215, 200), tint = colour::rgb(0x56b4e9),
                  lit = colour::rgb(0xf0e442);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  for (std::size_t i = 0; i < view.landmarks.size(); ++i) {
    const auto at = screen_place(
        input.camera, r,
        place_of(view.landmarks[i], input.scene.parts, *input.frame, input.displayed_face));
    const ImVec2 p = {static_cast<float>(at.x()), static_cast<float>(at.y())};
    const bool chosen = view.landmark == i;
    const bool named = chosen || std::hypot(p.x - mouse.x, p.y - mouse.y) < pen.px(9);
    list.AddCircleFilled(p, pen.px(5), edge, 20);
    list.AddCircleFilled(p, pen.px(3.5f), chosen ? lit : tint, 20);
    if (!named) continue;
    const std::string words = display_name(view.landmarks[i].name);
    const float wide = text_width(theme.small, words), high = theme.small->FontSize;
    const ImVec2 low = {p.x + pen.px(10), p.y - high / 2};
    list.AddRectFilled({low.x - pen.px(4), low.y - pen.px(2)},
                       {low.x + wide + pen.px(4), low.y + high + pen.px(2)}, edge, pen.px(3));
    list.AddText(theme.small, high, low, chosen ? lit : colour::rgb(0xe4e8ec), words.c_str());
  }
  list.PopClipRect();
}

void Panels::Drawing::landmark_list() {
  PanelFormState& form = panels.form_;
  const float foot = 5 * pen.px(landmark_button_high) + pen.px(34);
  const float all_rows =
      ImGui::GetTextLineHeightWithSpacing() * static_cast<float>(view.landmarks.size());
  ImGui::BeginChild("landmark-list", {0, std::clamp(ImGui::GetContentRegionAvail().y - foot,
                                                    pen.px(40), std::max(pen.px(80), all_rows))});
  for (std::size_t i = 0; i < view.landmarks.size(); ++i) {
    const std::string& name = view.landmarks[i].name;
    if (ImGui::Selectable((display_name(name) + "##" + name).c_str(), view.landmark == i)) {
      if (view.landmark == i)
        view.landmark.reset();
      else
        view.landmark = i;
      form.landmark_words = view.landmark ? display_name(name) : "";
    }
    pen.mark("landmark:" + name);
  }
  ImGui::EndChild();
}

/// A name and its buttons.
void Panels::Drawing::landmark_edits() {
  PanelFormState& form = panels.form_;
  const float button = pen.px(landmark_button_high), gap = pen.px(button_gap);
  const float whole = ImGui::GetContentRegionAvail().x;
  text_field(pen, "landmark-name", form.landmark_words, whole, "name");
  tooltip(pen, "Of a new landmark, or the new name of the chosen one");
  const std::string name = landmark_name(form.landmark_words);
  const bool taken = std::any_of(view.landmarks.begin(), view.landmarks.end(),
                                 [&](const Landmark& other) { return other.name == name; });
  const float third = width_of_each(pen, whole, 3);
  ImGui::BeginDisabled(name.empty() || taken);
  if (word_button(pen, "landmark-add", "Add", {third, button}, false)) {
    // At the centre of the others until a click places it.
    view.landmarks.push_back(landmark_at(name, input.camera.target, input.scene.parts));
    view.landmark = view.landmarks.size() - 1;
  }
  tooltip(pen, "A new landmark of this name; the next click on the surface places it");
  ImGui::SameLine(0, gap);
  ImGui::BeginDisabled(!view.landmark);
  if (word_button(pen, "landmark-rename", "Rename", {third, button}, false)) {
    view.landmarks[*view.landmark].name = name;
  }
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  ImGui::SameLine(0, gap);
  ImGui::BeginDisabled(!view.landmark);
  if (word_button(pen, "landmark-delete", "Delete", {third, button}, false)) {
    view.landmarks.erase(view.landmarks.begin() + static_cast<std::ptrdiff_t>(*view.landmark));
    view.landmark.reset();
    form.landmark_words.clear();
  }
  ImGui::EndDisabled();
}

/// Buttons to simulate with these landmarks and to save the case with them.
void Panels::Drawing::landmark_uses() {
  PanelFormState& form = panels.form_;
  const ImVec2 button = {ImGui::GetContentRegionAvail().x, pen.px(landmark_button_high)};
  const bool fresh = view.landmarks != input.scene.landmarks_in_use;
  ImGui::BeginDisabled(!fresh);
  if (word_button(pen, "landmarks-use", "Use in the simulation", button, fresh))
    panels.requests_.emplace_back(request::UseLandmarks{});
  ImGui::EndDisabled();
  tooltip(pen,
          "Jaw, muscles and tissue are built again for these landmarks; until then the simulation "
          "uses the earlier ones");
  if (form.case_folder.empty()) form.case_folder = input.scene.case_folder.string();
  text_field(pen, "case-folder", form.case_folder, button.x, "case folder");
  ImGui::BeginDisabled(form.case_folder.empty());
  if (word_button(pen, "case-save", "Save case", button, view.landmarks != input.scene.landmarks))
    panels.requests_.push_back(request::SaveCase{form.case_folder});
  ImGui::EndDisabled();
  tooltip(pen,
          "Writes the patient with these landmarks; an earlier case there is replaced when the new "
          "one is complete");
}

}  // namespace condyle
