#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/window/panels/panels_drawing.h"

namespace condyle {

// Centred, above everything, with the rest dimmed. ImGui needs a width for a usable layout.
bool begin_dialog(Pen& pen, const char* name, float dialog_width, double width, double height) {
  if (!ImGui::IsPopupOpen(name)) ImGui::OpenPopup(name);
  ImGui::SetNextWindowPos({static_cast<float>(width) / 2, static_cast<float>(height) / 2}, 0,
                          {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(dialog_width, static_cast<float>(width) - pen.px(20)), 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, pen.px(24, 20));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, pen.px(8));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, std::max(1.0f, pen.px(1)));
  const bool open =
      ImGui::BeginPopupModal(name, nullptr,
                             ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                 ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNavInputs);
  ImGui::PopStyleVar(3);
  if (open) {
    pen.panel = name;
    const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    pen.items.push_back({name, "", {low.x, low.y, size.x, size.y}});
  }
  return open;
}

namespace {

bool close_button(Pen& pen, const char* name) {
  const float wide = pen.px(96);
  ImGui::SetCursorPos(
      {ImGui::GetWindowContentRegionMax().x - wide, ImGui::GetCursorPosY() + pen.px(8)});
  const bool pressed = word_button(pen, name, "Close", {wide, pen.px(30)}, true);
  return pressed;
}

void help_columns(const Theme& theme, Pen& pen) {
  // Two columns of two groups each.
  const float column = ImGui::GetContentRegionAvail().x / 2;
  const float left = ImGui::GetCursorPosX(), top = ImGui::GetCursorPosY();
  const float keys_width = pen.px(150);
  const auto groups = help_groups();
  float lowest = top;
  for (std::size_t c = 0; c < 2; ++c) {
    ImGui::SetCursorPosY(top);
    for (std::size_t g = c; g < groups.size(); g += 2) {
      const float x = left + column * static_cast<float>(c);
      ImGui::SetCursorPosX(x);
      text(theme.bold, palette().accent, std::string(groups[g].title));
      for (const HelpLine& line : groups[g].lines) {
        ImGui::SetCursorPosX(x);
        text(theme.regular, palette().text, std::string(line.keys));
        ImGui::SameLine(x + keys_width);
        text(theme.regular, palette().text_dim, std::string(line.meaning));
      }
      ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(12));
    }
    lowest = std::max(lowest, ImGui::GetCursorPosY());
  }
  ImGui::SetCursorPosY(lowest);
}

}  // namespace

/// Hint beside the button of a dialog, once a key was pressed that it does not accept.
void Panels::Drawing::key_hint(const char* words) {
  if (!panels.key_refused_) return;
  const float y = ImGui::GetCursorPosY();
  ImGui::SetCursorPosY(y + pen.px(15));
  text(panels.theme_.small, palette().warning, words);
  pen.mark("key-hint", words);
  ImGui::SetCursorPosY(y);
}

void Panels::Drawing::question_dialog() {
  const Question& asked = *panels.question();
  text(panels.theme_.bold, palette().text, asked.title);
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(4));
  ImGui::PushTextWrapPos(0);
  text(panels.theme_.regular, palette().text_dim, asked.words);
  ImGui::PopTextWrapPos();
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(10));
  const auto count = static_cast<float>(asked.answers.size());
  const float gap = pen.px(8);
  const float wide =
      std::floor((ImGui::GetContentRegionAvail().x - gap * (count - 1)) / std::max(1.0f, count));
  std::optional<std::size_t> given;
  for (std::size_t i = 0; i < asked.answers.size(); ++i) {
    if (i > 0) ImGui::SameLine(0, gap);
    const Question::Answer& one = asked.answers[i];
    if (word_button(pen, one.item.c_str(), one.label.c_str(), {wide, pen.px(30)}, i == 0))
      given = i;
  }
  key_hint("Other keys wait for the answer; Esc leaves the question");
  if (given) panels.answer(*given);
}

void Panels::Drawing::dialogs() {
  const Theme& theme = panels.theme_;
  // An error precedes the help. A dialog closed by its key must be drawn once more, or ImGui would
  // keep waiting for it.
  const bool error = !panels.errors_.empty();
  if ((error || ImGui::IsPopupOpen("error")) &&
      begin_dialog(pen, "error", pen.px(460), display_width, display_height)) {
    if (error) {
      const Trouble& trouble = panels.errors_.front();
      text(theme.bold, palette().warning, trouble.title);
      pen.mark("error-title", trouble.title);
      ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(4));
      ImGui::PushTextWrapPos(0);
      text(theme.regular, palette().text, trouble.sentence);
      ImGui::PopTextWrapPos();
      key_hint("Other keys wait: Enter or Esc closes this");
      if (close_button(pen, "close-error")) panels.errors_.pop_front();
    }
    if (panels.errors_.empty()) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
  }
  const bool question = panels.question() && !error;
  if ((question || ImGui::IsPopupOpen("question")) &&
      begin_dialog(pen, "question", pen.px(480), display_width, display_height)) {
    if (question) question_dialog();
    if (!question || !panels.question()) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
  }
  auto& files = panels.form_.files;
  auto& import = panels.form_.import;
  const bool asks = import && !error && !question,
             opens = files.open && !asks && !error && !question;
  const bool saves = panels.form_.session.open && !asks && !opens && !error && !question;
  if ((asks || ImGui::IsPopupOpen("import")) &&
      begin_dialog(pen, "import", pen.px(560), display_width, display_height)) {
    if (asks) import_dialog();
    if (!asks || !import) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
  }
  if ((opens || ImGui::IsPopupOpen("open")) &&
      begin_dialog(pen, "open", pen.px(700), display_width, display_height)) {
    if (opens) open_dialog();
    if (!opens || !files.open) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
  }
  if ((saves || ImGui::IsPopupOpen("session")) &&
      begin_dialog(pen, "session", pen.px(560), display_width, display_height)) {
    if (saves) session_dialog();
    if (!saves || !panels.form_.session.open) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
  }
  const bool help = panels.help_open_ && !saves && !error && !question && !asks && !opens;
  if ((help || ImGui::IsPopupOpen("help")) &&
      begin_dialog(pen, "help", pen.px(820), display_width, display_height)) {
    if (help) {
      text(theme.bold, palette().text, "Keys and mouse");
      ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(6));
      help_columns(theme, pen);
      key_hint("Other keys wait: Esc closes this help");
      if (close_button(pen, "close-help")) panels.help_open_ = false;
    }
    if (!help || !panels.help_open_) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
  }
}

}  // namespace condyle
