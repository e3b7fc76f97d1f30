#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

struct SkinChoice {
  const char* name;
  const char* label;
  double opacity;
};
constexpr SkinChoice skin_choices[] = {
    {"skin:off", "Off", 0}, {"skin:glass", "Glass", 0.35}, {"skin:full", "Full", 1}};

/// The largest height within the given one that ends between two lines of the sentences.
float whole_lines(ImFont* font, const std::vector<std::string>& sentences, float room,
                  float width) {
  const float between = ImGui::GetStyle().ItemSpacing.y,
              wrapped = width - ImGui::GetStyle().ScrollbarSize;
  float y = 0, fits = font->FontSize;
  for (const std::string& words : sentences) {
    const float high = font->CalcTextSizeA(font->FontSize, 1e6f, wrapped, words.c_str()).y;
    for (float line = font->FontSize; line < high + 0.5f; line += font->FontSize)
      if (y + line <= room) fits = y + line;
    y += high + between;
  }
  return y - between <= room ? room : fits;
}

/// Height of all sentences in a column of this width.
float height_of(ImFont* font, const std::vector<std::string>& sentences, float width) {
  const float wrapped = width - ImGui::GetStyle().ScrollbarSize;
  float high = 0;
  for (const std::string& words : sentences)
    high += font->CalcTextSizeA(font->FontSize, 1e6f, wrapped, words.c_str()).y +
            ImGui::GetStyle().ItemSpacing.y;
  return high;
}

}  // namespace

void Panels::Drawing::parts() {
  begin_panel(pen, "left", layout.left);
  const float tab_gap = pen.px(4);
  const float tab_wide = std::floor((ImGui::GetContentRegionAvail().x - tab_gap) / 2);
  constexpr std::pair<LeftTab, const char*> tabs[] = {{LeftTab::parts, "Parts"},
                                                      {LeftTab::look, "Look"}};
  for (const auto& [tab, label] : tabs) {
    if (tab != LeftTab::parts) ImGui::SameLine(0, tab_gap);
    if (word_button(pen, (std::string("left-tab:") + label).c_str(), label, {tab_wide, pen.px(26)},
                    view.left_tab == tab))
      view.left_tab = tab;
  }
  if (view.left_tab == LeftTab::look)
    look();
  else
    part_list();
  end_panel();
}

/// Height of the notes with their heading: six lines if the list of parts leaves `left` for them,
/// at least two.
float Panels::Drawing::notes_room(float left) const {
  constexpr float lines = 6;
  if (input.scene.notes.empty()) return 0;
  const ImFont& font = *panels.theme_.small;
  const float gaps = (lines - 1) * ImGui::GetStyle().ItemSpacing.y;
  const float needed =
      std::min(lines * font.FontSize + gaps,
               height_of(panels.theme_.small, input.scene.notes, ImGui::GetContentRegionAvail().x));
  return std::clamp(left, pen.px(74), std::max(pen.px(74), pen.px(38) + needed));
}

void Panels::Drawing::part_list() {
  const Theme& theme = panels.theme_;
  // Skin first: it hides everything else.
  bool has_face = false;
  for (const Part& part : input.scene.parts) has_face |= part.role == Role::face;
  if (has_face) {
    heading(pen, "Skin", fmt::format("{:.0f} %", 100 * view.skin_opacity));
    slider(pen, "skin", view.skin_opacity,
           {.width = ImGui::GetContentRegionAvail().x, .typed = 100});
    tooltip(pen,
            "How dense the skin is. Key K turns it on and off; off leaves bones and teeth alone");
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
  const float list = row * static_cast<float>(tree_rows());
  const float shared =
      ImGui::GetContentRegionAvail().y - pen.px(34) - 2 * row;  // by the list and the notes
  const float most = std::max(2 * row, shared - notes_room(shared - list));
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 3));
  ImGui::BeginChild("part-list", {0, std::min(list, most)});
  tree();
  ImGui::EndChild();

  heading(pen, "Settings");
  tick_box(pen, "obey-contact", "Stop at contact", view.obey_contact);
  tooltip(pen, "On: bones cannot pass through each other. Off: the motion is played as it is");
  tick_box(pen, "mark-contacts", "Mark contacts", view.mark_contacts);
  tooltip(pen, "Points where bones or teeth touch");
  ImGui::PopStyleVar();

  if (!input.scene.notes.empty()) {
    heading(pen, "Notes");
    const ImVec2 room = ImGui::GetContentRegionAvail();
    ImGui::BeginChild("notes", {0, whole_lines(theme.small, input.scene.notes,
                                               std::max(pen.px(20), room.y), room.x)});
    ImGui::PushTextWrapPos(0);
    for (const std::string& note : input.scene.notes) text(theme.small, palette().text, note);
    ImGui::PopTextWrapPos();
    ImGui::EndChild();
    pen.mark("notes");
  }
}

}  // namespace condyle
