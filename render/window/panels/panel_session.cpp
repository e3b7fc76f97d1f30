#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

/// A file name of the patient's name, in the current folder.
std::string proposed_session_file(const WindowScene& scene) {
  std::string name;
  for (const char c : scene.case_name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ||
                       static_cast<unsigned char>(c) >= 0x80;
    if (plain)
      name += c;
    else if (!name.empty() && name.back() != '-')
      name += '-';
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  std::error_code ignored;
  return (fs::current_path(ignored) / ((name.empty() ? "patient" : name) + ".condyle-session"))
      .string();
}

fs::path session_path(const std::string& words) {
  const char* home = std::getenv("HOME");
  return words.starts_with("~/") && home ? fs::path(home) / words.substr(2) : fs::path(words);
}

}  // namespace

bool Panels::run_session(Command command, const WindowScene& scene) {
  if (command != Command::save_session && command != Command::save_session_as) return false;
  if (scene.parts.empty()) return true;  // there is nothing to save yet
  if (command == Command::save_session && !scene.session.empty()) {
    requests_.push_back(request::SaveSession{scene.session, true});
    return true;
  }
  form_.session.open = true;
  form_.session.path =
      scene.session.empty() ? proposed_session_file(scene) : scene.session.string();
  return true;
}

/// The field for a file, and the buttons.
void Panels::Drawing::session_dialog() {
  PanelFormState::SessionFields& fields = panels.form_.session;
  text(panels.theme_.bold, palette().text, "Save the session");
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(4));
  const float button = pen.px(96), gap = pen.px(8);
  const float whole = ImGui::GetContentRegionAvail().x;
  const bool entered =
      text_field(pen, "session-path", fields.path, whole - (input.file_dialog ? button + gap : 0),
                 "NAME.condyle-session");
  bool close = false;
  if (input.file_dialog) {
    ImGui::SameLine(0, gap);
    if (word_button(pen, "session-browse", "Browse...", {button, ImGui::GetFrameHeight()}, false)) {
      panels.requests_.push_back(
          request::Browse{request::Browse::Purpose::save_session, session_path(fields.path)});
      close = true;
    }
    tooltip(pen, "The file dialog of the desktop");
  }
  ImGui::PushTextWrapPos(0);
  text(panels.theme_.small, palette().text_dim,
       "The file holds the view, looks, measures, landmarks and hand positions. It refers to the "
       "files of patient and plan; a plan that has no file yet is stored in it. Open it with Open "
       "(Ctrl+O), or condyle view FILE.");
  ImGui::PopTextWrapPos();
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(8));
  ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - 2 * button - gap);
  close |= word_button(pen, "session-close", "Close", {button, pen.px(30)}, false);
  ImGui::SameLine(0, gap);
  const bool go = word_button(pen, "session-go", "Save", {button, pen.px(30)}, true);
  if ((go || entered || std::exchange(fields.accepted, false)) && !fields.path.empty()) {
    const fs::path file = session_path(fields.path);
    panels.requests_.push_back(request::SaveSession{file, false});
    close = true;
  }
  if (close) fields.open = false;
}

}  // namespace condyle
