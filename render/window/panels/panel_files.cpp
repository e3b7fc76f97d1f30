#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace fs = std::filesystem;

void PanelFormState::OpenFields::choose(std::size_t file, bool ctrl, bool shift) {
  path.clear();  // only one of them is opened
  if (!ctrl) chosen.clear();
  if (shift) {
    for (std::size_t i = std::min(anchor, file); i <= std::max(anchor, file); ++i) chosen.insert(i);
    return;
  }
  anchor = file;
  if (!chosen.insert(file).second) chosen.erase(file);
}

std::vector<fs::path> PanelFormState::OpenFields::chosen_files() const {
  std::vector<fs::path> all;
  for (const std::size_t i : chosen) all.push_back(files.at(i));
  return all;
}

namespace {

/// Whether the file begins as one of a DICOM series.
bool begins_as_dicom(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  char mark[4] = {};
  stream.seekg(128);
  stream.read(mark, 4);
  return stream && std::string_view(mark, 4) == "DICM";
}

/// Reads a folder: its subfolders, and the files that can be opened, each sorted.
void list_folder(PanelFormState::OpenFields& fields) {
  fields.listed = fields.folder;
  fields.folders.clear();
  fields.files.clear();
  fields.chosen.clear();
  fields.anchor = 0;
  fields.holds_scan = false;
  int looked_at = 0;
  std::error_code error;
  for (auto it = fs::directory_iterator(fields.folder,
                                        fs::directory_options::skip_permission_denied, error);
       !error && it != fs::directory_iterator(); it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with('.')) continue;
    std::error_code ignored;
    if (it->is_directory(ignored)) {
      fields.folders.push_back(it->path());
      continue;
    }
    constexpr int most_looked_at = 20;
    if (!fields.holds_scan && it->is_regular_file(ignored) && looked_at++ < most_looked_at)
      fields.holds_scan = begins_as_dicom(it->path());
    std::string ending = it->path().extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    for (const char* known :
         {".stl",  ".ply",  ".obj", ".glb", ".gltf", ".csv",  ".motion",
          ".mot",  ".sto",  ".trc", ".raw", ".txt",  ".json", ".condyle-session",
          ".nrrd", ".nhdr", ".mha", ".mhd", ".nii",  ".gz",   ".dcm"})
      if (ending == known && (ending != ".json" || name.ends_with(".mrk.json")) &&
          (ending != ".gz" || name.ends_with(".nii.gz")))
        fields.files.push_back(it->path());
  }
  std::sort(fields.folders.begin(), fields.folders.end());
  std::sort(fields.files.begin(), fields.files.end());
}

bool is_case(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "case.json", ignored);
}

fs::path typed_path(const std::string& words) {
  const char* home = std::getenv("HOME");
  return words.starts_with("~/") && home ? fs::path(home) / words.substr(2) : fs::path(words);
}

constexpr float list_gap = 8, list_high = 250;  // at scale 1

constexpr const char* roles[] = {
    "",     "skull",   "maxilla",    "mandible",  "upper-teeth", "lower-teeth",
    "face", "segment", "transplant", "landmarks", "muscles"};
const char* role_words(const std::string& role) {
  return role.empty() ? "leave out" : role.c_str();
}

/// Message on the roles, and whether they are not yet sufficient for a patient.
struct RoleRemark {
  std::string words;
  bool hinders = false;
};
RoleRemark remark_on(const request::Import& import) {
  const auto count = [&](const std::string& role) {
    return std::count_if(import.files.begin(), import.files.end(),
                         [&](const FileRole& one) { return one.role == role; });
  };
  if (count("skull") + count("maxilla") + count("mandible") == 0)
    return {"No surface is a bone yet: choose skull, maxilla or mandible for at least one of them",
            true};
  for (const std::string once : {"face", "landmarks", "muscles"})
    if (count(once) > 1)
      return {fmt::format("{} files are said to be {}, but there can be only one: choose another "
                          "role or \"leave out\" for the others",
                          count(once), once == "face" ? "the face" : once),
              true};
  std::string words;
  const auto add = [&](const std::string& sentence) {
    words += (words.empty() ? "" : "\n") + sentence;
  };
  std::string again;
  for (const FileRole& one : import.files)
    if (one.role.empty() && !one.taken.empty())
      again += fmt::format("{}{} ({})", again.empty() ? "" : ", ", one.file.filename().string(),
                           one.taken);
  if (!again.empty())
    add("By their names these are the same once more, and are left out: " + again);
  for (const char* bone : {"mandible", "skull", "maxilla"})
    if (count(bone) > 1)
      add(
          fmt::format("{} surfaces are said to be the {}. That is right for pieces of one bone; "
                      "of the same bone twice, choose \"leave out\" for one",
                      count(bone), bone));
  return {words};
}

bool choice(Pen& pen, const std::string& name, float width, std::string& value,
            std::span<const char* const> choices) {
  bool changed = false;
  ImGui::SetNextItemWidth(width);
  if (ImGui::BeginCombo(("##" + name).c_str(), role_words(value))) {
    for (const char* one : choices) {
      if (ImGui::Selectable(role_words(one), value == one)) {
        value = one;
        changed = true;
      }
      pen.mark(name + ":" + one);
    }
    ImGui::EndCombo();
  }
  pen.mark(name);
  return changed;
}

/// Width of each of the two lists of the dialog.
float list_column(const Pen& pen) {
  return std::floor((ImGui::GetContentRegionAvail().x - pen.px(list_gap)) / 2);
}

}  // namespace

void Panels::Drawing::open_dialog() {
  PanelFormState::OpenFields& fields = panels.form_.files;
  OpenChoice chosen;
  text(panels.theme_.bold, palette().text, "Open");
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(4));
  const float column = list_column(pen);
  ImGui::PushStyleColor(ImGuiCol_ChildBg, palette().well);
  recent_list(column, chosen);
  ImGui::SameLine(0, pen.px(list_gap));
  folder_list(column, chosen);
  ImGui::PopStyleColor();
  const char* help[] = {
      "A session, a patient's folder, a motion (CSV, .motion, .mot, .trc ...), a CT (DICOM folder, "
      "NRRD, NIfTI, MetaImage), or",
      "a patient's surfaces (STL, PLY, OBJ, glTF) and landmarks, several at once: Ctrl+click adds "
      "one, Shift+click all up to it"};
  for (const char* line : help) text(panels.theme_.small, palette().text_dim, line);
  open_path(chosen);
  if (!chosen.files.empty()) panels.requests_.push_back(request::Open{chosen.files});
  if (chosen.builtin) panels.requests_.push_back(request::Open{});
  if (!chosen.files.empty() || chosen.builtin || chosen.close) {
    fields.open = false;
    fields.chosen.clear();
  }
}

void Panels::Drawing::recent_list(float column, OpenChoice& chosen) {
  const Theme& theme = panels.theme_;
  ImGui::BeginGroup();
  text(theme.small, palette().text_dim, "Opened before");
  ImGui::BeginChild("recent", {column, pen.px(list_high)}, false,
                    ImGuiWindowFlags_AlwaysUseWindowPadding);
  if (ImGui::Selectable("Built-in patient")) chosen.builtin = true;
  pen.mark("open:builtin");
  for (std::size_t i = 0; i < input.scene.recent.size(); ++i) {
    const fs::path& path = input.scene.recent[i];
    const std::string label = fitted(theme.regular, path.filename().string(), column - pen.px(32));
    if (ImGui::Selectable((label + "##" + std::to_string(i)).c_str())) chosen.files = {path};
    pen.mark(fmt::format("recent:{}", i));
    tooltip(pen, path.c_str());
  }
  ImGui::EndChild();
  ImGui::EndGroup();
}

void Panels::Drawing::folder_list(float column, OpenChoice& chosen) {
  const Theme& theme = panels.theme_;
  PanelFormState::OpenFields& fields = panels.form_.files;
  ImGui::BeginGroup();
  if (fields.folder.empty()) {
    std::error_code ignored;
    fields.folder = fs::current_path(ignored);
  }
  if (fields.folder != fields.listed) list_folder(fields);
  text(theme.small, palette().text_dim, fitted(theme.small, fields.folder.string(), column));
  tooltip(pen, fields.folder.c_str());
  ImGui::BeginChild("folder", {column, pen.px(list_high)}, false,
                    ImGuiWindowFlags_AlwaysUseWindowPadding);
  if (fields.folder.has_parent_path() && ImGui::Selectable(".."))
    fields.folder = fields.folder.parent_path();
  if (fields.holds_scan) {
    if (ImGui::Selectable("CT scan in this folder")) chosen.files = {fields.folder};
    pen.mark("open:scan");
  }
  const auto row = [&](const fs::path& path, const std::string& end, bool is_chosen = false) {
    const std::string label =
        fitted(theme.regular, path.filename().string() + end, column - pen.px(32));
    const bool pressed = select_row(label + "##" + path.filename().string(), is_chosen);
    pen.mark("file:" + path.filename().string(), is_chosen ? "chosen" : "");
    if (label.ends_with("...")) tooltip(pen, path.filename().c_str());
    return pressed;
  };
  for (const fs::path& folder : fields.folders) {
    const bool patient = is_case(folder);
    if (!row(folder, patient ? "   (patient)" : "/")) continue;
    if (patient)
      chosen.files = {folder};
    else
      fields.folder = folder;
  }
  for (std::size_t i = 0; i < fields.files.size(); ++i) {
    if (!row(fields.files[i], "", fields.chosen.contains(i))) continue;
    const ImGuiIO& io = ImGui::GetIO();
    fields.choose(i, io.KeyCtrl, io.KeyShift);
    if (ImGui::IsMouseDoubleClicked(0) && !io.KeyCtrl && !io.KeyShift)
      chosen.files = {fields.files[i]};
  }
  ImGui::EndChild();
  ImGui::EndGroup();
}

/// The field for a path, and the buttons.
void Panels::Drawing::open_path(OpenChoice& chosen) {
  PanelFormState::OpenFields& fields = panels.form_.files;
  const float button = pen.px(96), gap = pen.px(list_gap), buttons = input.file_dialog ? 3 : 2;
  const std::vector<fs::path> listed = fields.chosen_files();
  const std::string hint = listed.empty()       ? "path of a file or folder"
                           : listed.size() == 1 ? listed.front().filename().string()
                                                : fmt::format("{} files are chosen", listed.size());
  const bool entered =
      text_field(pen, "open-path", fields.path,
                 ImGui::GetContentRegionAvail().x - buttons * (button + gap), hint.c_str());
  if (!fields.path.empty()) fields.chosen.clear();
  ImGui::SameLine(0, gap);
  const bool go = word_button(
      pen, "open-go", listed.size() > 1 ? fmt::format("Open {}", listed.size()).c_str() : "Open",
      {button, ImGui::GetFrameHeight()}, true);
  if (go || entered || std::exchange(fields.accepted, false)) {
    const fs::path typed = typed_path(fields.path);
    std::error_code ignored;
    if (typed.empty()) {
      chosen.files = listed;
    } else if (fs::is_directory(typed, ignored) && !is_case(typed)) {
      fields.folder = typed;  // to be listed
      fields.path.clear();
    } else {
      chosen.files = {typed};
    }
  }
  if (input.file_dialog) {
    ImGui::SameLine(0, gap);
    if (word_button(pen, "open-browse", "Browse...", {button, ImGui::GetFrameHeight()}, false)) {
      panels.requests_.push_back(
          request::Browse{request::Browse::Purpose::open, fields.folder / ""});
      chosen.close = true;
    }
    tooltip(pen, "The file dialog of the desktop");
  }
  ImGui::SameLine(0, gap);
  chosen.close |= word_button(pen, "close-open", "Close", {button, ImGui::GetFrameHeight()}, false);
}

void Panels::Drawing::import_dialog() {
  const Theme& theme = panels.theme_;
  request::Import& import = *panels.form_.import;
  constexpr const char* units[] = {"mm", "cm", "m", "in"};
  constexpr const char* frames[] = {"LPS", "RAS", "LAS", "RPS", "RSA", "LSA", "RIP", "LIP"};
  text(theme.bold, palette().text, "What are these surfaces?");
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(4));
  const float whole = ImGui::GetContentRegionAvail().x, right = pen.px(150);
  const float row = ImGui::GetFrameHeightWithSpacing();
  ImGui::BeginChild(
      "import-list",
      {0, row * static_cast<float>(std::clamp<std::size_t>(import.files.size(), 1, 8))});
  for (std::size_t i = 0; i < import.files.size(); ++i) {
    FileRole& one = import.files[i];
    ImGui::PushID(static_cast<int>(i));
    ImGui::AlignTextToFramePadding();
    text(theme.regular, palette().text,
         fitted(theme.regular, one.file.filename().string(), whole - right - pen.px(20)));
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - right);
    choice(pen, fmt::format("import-role:{}", i), right, one.role, roles);
    ImGui::PopID();
  }
  ImGui::EndChild();
  const auto line = [&](const char* words, const char* name, std::string& value,
                        std::span<const char* const> choices, const char* help) {
    ImGui::AlignTextToFramePadding();
    text(theme.regular, palette().text_dim, words);
    ImGui::SameLine(whole - right + ImGui::GetCursorStartPos().x);
    choice(pen, name, right, value, choices);
    tooltip(pen, help);
  };
  line("Unit of lengths", "import-units", import.units, units,
       "Of the surfaces; landmarks are in mm");
  line("Directions of the axes", "import-frame", import.frame, frames,
       "L left, R right, P back, A front, S up, I down: where x, y and z point. Scanners and 3D "
       "Slicer's files are mostly LPS or RAS");
  const RoleRemark remark = remark_on(import);
  if (!remark.words.empty()) {
    ImGui::PushTextWrapPos(0);
    text(theme.small, remark.hinders ? palette().warning : palette().text_dim, remark.words);
    ImGui::PopTextWrapPos();
    pen.mark("import-remark", remark.words);
  }
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(8));
  const float button = pen.px(130);
  ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - 2 * button - pen.px(8));
  const bool close =
      word_button(pen, "import-close", "Leave them out", {button, pen.px(30)}, false);
  ImGui::SameLine(0, pen.px(8));
  ImGui::BeginDisabled(remark.hinders);
  const bool go = word_button(pen, "import-go", "Make a patient", {button, pen.px(30)}, true);
  ImGui::EndDisabled();
  if (go) panels.requests_.push_back(import);
  if (go || close) panels.form_.import.reset();
}

}  // namespace condyle
