#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "render/window/handles.h"
#include "render/window/panels_drawing.h"

namespace condyle {

void Panels::Drawing::landmarks() {
  if (!input.frame) return;
  const Theme& theme = panels.theme_;
  Drafts& drafts = panels.drafts_;
  const ViewRect& r = layout.view;

  // On the picture: all as dots, with a name where the mouse or the choice is.
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.PushClipRect({static_cast<float>(r.x), static_cast<float>(r.y)},
                    {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  constexpr ImU32 edge = colour::rgb(0x0f1215, 200), tint = colour::rgb(0x56b4e9),
                  lit = colour::rgb(0xf0e442);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  for (std::size_t i = 0; i < view.landmarks.size(); ++i) {
    const auto at =
        screen_place(input.camera, r,
                     place_of(view.landmarks[i], input.scene.parts, *input.frame, input.seen_face));
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

  if (layout.tool.width <= 0) return;
  const float button = pen.px(26), foot = 5 * button + pen.px(34);
  begin_panel(pen, "landmarks", layout.tool);
  heading(pen, "Landmarks", fmt::format("{}", view.landmarks.size()));
  const float gap = pen.px(5);
  const float whole = ImGui::GetContentRegionAvail().x;
  ImGui::PushTextWrapPos(0);
  text(theme.small, palette().text_dim,
       view.landmark ? "Click on the surface to place it."
                     : "Choose one, then click on the surface.");
  ImGui::PopTextWrapPos();
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
      drafts.landmark_words = view.landmark ? display_name(name) : "";
    }
    pen.mark("landmark:" + name);
  }
  ImGui::EndChild();

  text_field(pen, "landmark-name", drafts.landmark_words, whole, "name");
  tooltip(pen, "Of a new landmark, or the new name of the chosen one");
  const std::string name = landmark_name(drafts.landmark_words);
  const bool taken = std::any_of(view.landmarks.begin(), view.landmarks.end(),
                                 [&](const Landmark& other) { return other.name == name; });
  const float third = std::floor((whole - 2 * gap) / 3);
  ImGui::BeginDisabled(name.empty() || taken);
  if (word_button(pen, "landmark-add", "Add", {third, button}, false)) {
    // In the middle of what is there until it is placed by a click.
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
    drafts.landmark_words.clear();
  }
  ImGui::EndDisabled();
  const bool fresh = view.landmarks != input.scene.landmarks_in_use;
  ImGui::BeginDisabled(!fresh);
  if (word_button(pen, "landmarks-use", "Use in the simulation", {whole, button}, fresh))
    panels.wishes_.emplace_back(wish::UseLandmarks{});
  ImGui::EndDisabled();
  tooltip(pen,
          "Jaw, muscles and tissue are made anew for these landmarks; meanwhile all goes on with "
          "the earlier ones");
  if (drafts.case_folder.empty()) drafts.case_folder = input.scene.case_folder.string();
  text_field(pen, "case-folder", drafts.case_folder, whole, "case folder");
  ImGui::BeginDisabled(drafts.case_folder.empty());
  if (word_button(pen, "case-save", "Save case", {whole, button},
                  view.landmarks != input.scene.landmarks))
    panels.wishes_.push_back(wish::SaveCase{drafts.case_folder});
  ImGui::EndDisabled();
  tooltip(pen,
          "Writes the patient with these landmarks; an earlier case there is replaced when the new "
          "one is whole");
  end_panel();
}

}  // namespace condyle
