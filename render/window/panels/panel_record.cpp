#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/window/panels/panels_drawing.h"
#include "render/window/picture/picture_files.h"

namespace condyle {
namespace {

struct NamedCamera {
  const char* name;
  const char* label;
};
constexpr std::array<NamedCamera, 11> named_cameras = {{{own_camera, "This view"},
                                                        {turning_camera, "This view, turning once"},
                                                        {"front", "Front"},
                                                        {"left", "Left"},
                                                        {"right", "Right"},
                                                        {"three-quarter", "Three-quarter"},
                                                        {"back", "Back"},
                                                        {"above", "Above"},
                                                        {"below", "Below"},
                                                        {"upper-arch", "Upper arch"},
                                                        {"lower-arch", "Lower arch"}}};

/// A row of choices over `width`. Returns true when another one is chosen.
template <class Value, class Choices>
bool choice_row(Pen& pen, const char* item, Value& value, const Choices& choices, float width,
                const char* help) {
  const float wide = width_of_each(pen, width, static_cast<int>(choices.size()));
  const Value before = value;
  bool first = true;
  for (const auto& [number, words] : choices) {
    if (!std::exchange(first, false)) ImGui::SameLine(0, pen.px(button_gap));
    if (word_button(pen, fmt::format("{}:{}", item, number).c_str(), words, {wide, pen.px(24)},
                    before == number))
      value = number;
    tooltip(pen, help);
  }
  return value != before;
}

using FourChoices = std::array<std::pair<int, const char*>, 4>;

int width_of_screen(int height) { return static_cast<int>(std::lround(height * 16 / 9.0)); }

}  // namespace

std::vector<std::string> RecordChoice::selected_cameras() const {
  std::vector<std::string> selected;
  for (const NamedCamera& one : named_cameras)
    if (cameras.contains(one.name)) selected.emplace_back(one.name);
  if (camera_from_file && !camera_file.empty()) selected.push_back(camera_file);
  return selected;
}

/// Label at the start of a line. Returns the remaining width for the field.
float Panels::Drawing::record_label(const char* words) {
  const float left = ImGui::GetStyle().WindowPadding.x, wide = pen.px(84);
  const float whole = ImGui::GetContentRegionAvail().x, y = ImGui::GetCursorPosY();
  const float lower = (ImGui::GetFrameHeight() - pen.theme.small->FontSize) / 2;
  ImGui::SetCursorPosY(y + lower);
  text(pen.theme.small, palette().text_dim, words);
  ImGui::SameLine();
  ImGui::SetCursorPos({left + wide, y});
  return whole - wide;
}

void Panels::Drawing::record_cameras() {
  RecordChoice& fields = panels.record_;
  std::string shown;
  const auto add = [&](const char* words) {
    shown += (shown.empty() ? "" : ", ") + std::string(words);
  };
  for (const NamedCamera& one : named_cameras)
    if (fields.cameras.contains(one.name)) add(one.label);
  if (fields.camera_from_file) add("a file");
  if (shown.empty()) shown = "No camera";
  const float room = record_label("Camera");
  ImGui::SetNextItemWidth(room);
  shown = fitted(pen.theme.regular, shown, room - 2 * ImGui::GetFrameHeight());
  if (ImGui::BeginCombo("##record-cameras", shown.c_str(), ImGuiComboFlags_HeightLargest)) {
    for (const NamedCamera& one : named_cameras) {
      bool on = fields.cameras.contains(one.name);
      if (!tick_box(pen, (std::string("camera:") + one.name).c_str(), one.label, on)) continue;
      if (on)
        fields.cameras.insert(one.name);
      else
        fields.cameras.erase(one.name);
    }
    tick_box(pen, "camera:file", "A view or a path from a file", fields.camera_from_file);
    ImGui::EndCombo();
  }
  pen.mark("record-cameras", shown);
  tooltip(
      pen,
      "Views of the motion. Several cameras record at once, each into its own folder. Front, Left, "
      "the arches and so on are aligned with the skull's axes; only This view shows a skull that "
      "was moved as in the picture");
  if (!fields.camera_from_file) return;
  text_field(pen, "record-camera-file", fields.camera_file, record_label("File"), "camera.json");
  tooltip(pen,
          "A JSON file with a view or a path of views, e.g. {\"path\": [{\"view\": \"front\"}, "
          "{\"at\": 0.4, \"view\": \"left\", \"distance_mm\": 400}]}; condyle help pictures "
          "describes them");
}

void Panels::Drawing::record() {
  record_picture();
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 5));
  heading(pen, "Recording", "the whole motion");
  record_size();
  record_quality();
  record_cameras();
  record_contents();
  record_folder();
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(6));
  if (input.recording)
    record_progress();
  else
    record_button();
  ImGui::PopStyleVar();
  ImGui::PushTextWrapPos(0);
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(4));
  record_note();
  ImGui::PopTextWrapPos();
}

void Panels::Drawing::record_picture() {
  const float wide = width_of_each(pen, ImGui::GetContentRegionAvail().x, 2), high = pen.px(28);
  heading(pen, "Picture", "PNG");
  if (word_button(pen, "save-picture", "The view", {wide, high}, false))
    commands.push_back(Command::picture);
  tooltip(
      pen,
      "Saves the 3-D picture in full quality, on the background that it has here: light or dark as "
      "the panels (T). F12");
  ImGui::SameLine(0, pen.px(button_gap));
  if (word_button(pen, "save-window", "The window", {wide, high}, false))
    commands.push_back(Command::window_picture);
  tooltip(pen, "Saves the window with its panels. Shift+F12");
}

/// Standard sizes by their height, and any other in pixels.
void Panels::Drawing::record_size() {
  RecordChoice& choice = panels.record_;
  int standard = choice.width == width_of_screen(choice.height) ? choice.height : 0;
  if (choice_row(pen, "record-height", standard,
                 FourChoices{{{720, "720"}, {1080, "1080"}, {1440, "1440"}, {2160, "4K"}}},
                 record_label("Height"), "Of the pictures, in pixels, as wide as a screen: 16:9")) {
    choice.height = standard;
    choice.width = width_of_screen(standard);
  }
  const float side = std::floor((record_label("Pixels") - pen.px(18)) / 2);
  const auto pixels = [&](const char* name, int& value) {
    double number = value;
    ImGui::SetNextItemWidth(side);
    if (number_field(pen, name, number, "%.0f", panels.form_.number))
      value = std::clamp(static_cast<int>(std::lround(std::clamp(number, 0.0, 1e6))),
                         min_picture_px, max_picture_px);
    tooltip(pen,
            "Any width and height, 16 to 8192 pixels; times the supersampling, up to the "
            "largest picture of the graphics driver; Record reports a size beyond it");
  };
  pixels("record-width", choice.width);
  ImGui::SameLine(0, pen.px(button_gap));
  ImGui::AlignTextToFramePadding();
  text(pen.theme.small, palette().text_dim, "\u00d7");
  ImGui::SameLine(0, pen.px(button_gap));
  pixels("record-tall", choice.height);
}

void Panels::Drawing::record_quality() {
  RecordChoice& choice = panels.record_;
  choice_row(pen, "record-rate", choice.frames_per_second,
             FourChoices{{{10, "10"}, {24, "24"}, {30, "30"}, {60, "60"}}},
             record_label("Per second"), "Pictures for each second of the motion");
  choice_row(
      pen, "record-finer", choice.supersampling,
      FourChoices{{{1, "1x"}, {2, "2x"}, {3, "3x"}, {4, "4x"}}}, record_label("Supersampling"),
      "Supersampling: draws the picture 2 to 4 times as wide and high, then averages: the finest "
      "lines and edges, but slower. At 1x edges are smoothed as selected below");
  int edges = static_cast<int>(choice.edges);
  choice_row(
      pen, "record-edges", edges,
      std::array<std::pair<int, const char*>, 3>{{{0, "MSAA"}, {1, "FXAA"}, {2, "None"}}},
      record_label("Edges"),
      "MSAA: four samples per pixel (best; a driver that offers fewer is reported). FXAA: a filter "
      "over the finished picture (quick). None: edges are not smoothed");
  choice.edges = static_cast<RecordEdges>(edges);
}

void Panels::Drawing::record_contents() {
  RecordChoice& choice = panels.record_;
  text_field(pen, "record-caption", choice.caption, record_label("Caption"),
             "Opening {opening} mm");
  tooltip(
      pen,
      "Text under the picture. Placeholders: {time} in s, {opening} in mm (descent of the lower "
      "incisal point), {interincisal} in mm (between the incisal edges), {rotation} in \u00b0, "
      "{motion}, {frame}. A | begins a new line");
  const float whole = ImGui::GetContentRegionAvail().x;
  tick_box(pen, "record-transparent", "No background", choice.transparent);
  tooltip(pen,
          "PNG pictures with a transparent background, to lay over others; in a film it is black");
  ImGui::SameLine(std::floor(whole * 0.56f));
  tick_box(pen, "record-film", "Film (MP4)", choice.film);
  tooltip(pen, "Beside the pictures; encoded by the program ffmpeg while they are drawn");
}

/// The next recording gets a new folder, unless the user names one or a question about it is open.
void Panels::Drawing::record_folder() {
  PanelFormState::RecordFields& fields = panels.form_.record;
  if (fields.running && !input.recording && !panels.question()) fields.folder.clear();
  fields.running = input.recording;
  if (fields.folder.empty()) fields.folder = next_recording_folder(input.recording_folder).string();
  const float browse = input.file_dialog ? pen.px(28 + button_gap) : 0;
  text_field(pen, "record-folder", fields.folder, record_label("Folder") - browse,
             "folder of the pictures");
  tooltip(pen, fields.folder.c_str());
  if (input.file_dialog) {
    ImGui::SameLine(0, pen.px(button_gap));
    if (word_button(pen, "record-browse", "...", {pen.px(28), ImGui::GetFrameHeight()}, false))
      panels.requests_.push_back(
          request::Browse{request::Browse::Purpose::record_folder, input.recording_folder / ""});
    tooltip(pen, "Choose a folder in the file dialog of the desktop");
  }
  if (input.recording_folder_name.empty()) return;
  const bool elsewhere =
      std::filesystem::path(fields.folder).parent_path() != input.recording_folder;
  record_label("");
  const std::string where = elsewhere ? " " : "in " + input.recording_folder_name;
  text(pen.theme.small, palette().text_dim, where);  // the line stays: what is below never moves
  if (elsewhere) return;
  pen.mark("record-where", where);
  tooltip(
      pen,
      "A new folder in the user's videos folder: XDG_VIDEOS_DIR of user-dirs.dirs, else ~/Videos "
      "where it exists, else the home folder");
}

void Panels::Drawing::record_progress() {
  const float whole = ImGui::GetContentRegionAvail().x;
  const float done = static_cast<float>(input.recording_fraction);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + whole, at.y + pen.px(6)}, palette().track, pen.px(3));
  list.AddRectFilled(at, {at.x + whole * done, at.y + pen.px(6)}, palette().accent, pen.px(3));
  ImGui::Dummy({whole, pen.px(8)});
  pen.mark("record-progress");
  text(pen.theme.small, palette().text, fitted(pen.theme.small, input.recording_what, whole));
  if (word_button(pen, "record-cancel", "Stop recording", {whole, pen.px(32)}, false))
    panels.requests_.emplace_back(request::StopRecording{});
  tooltip(pen, "The finished pictures stay in the folder; the recording can be resumed");
}

void Panels::Drawing::record_button() {
  const RecordChoice& choice = panels.record_;
  const std::string& folder = panels.form_.record.folder;
  const double duration = input.scene.duration_s;
  const std::vector<std::string> cameras = choice.selected_cameras();
  ImGui::BeginDisabled(duration <= 0 || folder.empty() || cameras.empty());
  if (word_button(pen, "record", "Record", {ImGui::GetContentRegionAvail().x, pen.px(32)}, true))
    panels.requests_.push_back(request::Record{.folder = folder,
                                               .width = choice.width,
                                               .height = choice.height,
                                               .frames_per_second = choice.frames_per_second,
                                               .film = choice.film,
                                               .cameras = cameras,
                                               .caption = choice.caption,
                                               .transparent = choice.transparent,
                                               .supersampling = choice.supersampling,
                                               .edges = choice.edges,
                                               .camera = input.camera,
                                               .picture = {}});
  ImGui::EndDisabled();
  const long frames = std::lround(duration * choice.frames_per_second) + 1;
  const std::string from_each =
      cameras.size() > 1 ? fmt::format(" from each of {} cameras", cameras.size()) : "";
  text(pen.theme.small, palette().text_dim,
       duration > 0 ? fmt::format("{} pictures{} of {:.2f} s", frames, from_each, duration)
                    : std::string("There is no motion to record"));
}

void Panels::Drawing::record_note() {
  if (input.unfinished.empty() || input.recording) {
    text(pen.theme.small, palette().text_dim,
         "Pictures are drawn in full quality in the background; the window stays usable. They show "
         "the present view, including bones moved by hand and its light or dark background (T).");
    return;
  }
  text(pen.theme.small, palette().text, input.unfinished);
  if (word_button(pen, "record-resume", "Resume this recording",
                  {ImGui::GetContentRegionAvail().x, pen.px(28)}, false))
    panels.requests_.emplace_back(request::ResumeRecording{});
  tooltip(
      pen,
      "Draws the missing pictures with the settings of the recording, regardless of the present "
      "view. The result is bit-identical to an uninterrupted one");
}

}  // namespace condyle
