#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/window/panels_drawing.h"
#include "render/window/picture_files.h"

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

}  // namespace

std::vector<std::string> RecordChoice::wanted_cameras() const {
  std::vector<std::string> wanted;
  for (const NamedCamera& one : named_cameras)
    if (cameras.contains(one.name)) wanted.emplace_back(one.name);
  if (camera_from_file && !camera_file.empty()) wanted.push_back(camera_file);
  return wanted;
}

/// What the rest of the line is. gives: the room that is left for it.
float Panels::Drawing::record_label(const char* words) {
  const float left = ImGui::GetStyle().WindowPadding.x, wide = pen.px(66);
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
      "Where the motion is seen from. Several cameras record at once, a folder for each. Front, "
      "Left, arches and the like look along the skull's own axes; only This view shows a skull "
      "that was moved as it stands in the picture");
  if (!fields.camera_from_file) return;
  text_field(pen, "record-camera-file", fields.camera_file, record_label("File"), "camera.json");
  tooltip(pen,
          "A JSON file with a view or a path of views, e.g. {\"path\": [{\"view\": \"front\"}, "
          "{\"at\": 0.4, \"view\": \"left\", \"distance_mm\": 400}]}; README.md tells more");
}

void Panels::Drawing::record() {
  const Theme& theme = panels.theme_;
  RecordChoice& choice = panels.record_;
  Drafts::RecordFields& fields = panels.drafts_.record;
  const float gap = pen.px(5), high = pen.px(28);
  const float whole = ImGui::GetContentRegionAvail().x;
  const auto share = [&](int n) {
    return std::floor((whole - gap * static_cast<float>(n - 1)) / static_cast<float>(n));
  };

  heading(pen, "Picture", "PNG");
  if (word_button(pen, "save-picture", "The view", {share(2), high}, false))
    commands.push_back(Command::picture);
  tooltip(
      pen,
      "Saves the 3-D picture in full quality, on the background that it has here: light or dark as "
      "the panels (T). F12");
  ImGui::SameLine(0, gap);
  if (word_button(pen, "save-window", "The window", {share(2), high}, false))
    commands.push_back(Command::window_picture);
  tooltip(pen, "Saves the window with its panels. Shift+F12");

  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 5));
  heading(pen, "Recording", "the whole motion");
  // A row of choices behind its name.
  const auto row = [&](const char* name, const char* item, auto& value, const auto& choices,
                       const char* help) {
    const auto count = static_cast<float>(choices.size());
    const float wide = std::floor((record_label(name) - (count - 1) * gap) / count);
    bool first = true;
    for (const auto& [number, words] : choices) {
      if (!std::exchange(first, false)) ImGui::SameLine(0, gap);
      if (word_button(pen, fmt::format("{}:{}", item, number).c_str(), words, {wide, pen.px(24)},
                      value == number))
        value = number;
      tooltip(pen, help);
    }
  };
  using Choices = std::array<std::pair<int, const char*>, 4>;
  // Usual sizes by their height, and any other in numbers.
  const auto width_of = [](int height) { return static_cast<int>(std::lround(height * 16 / 9.0)); };
  int usual = choice.width == width_of(choice.height) ? choice.height : 0;
  row("Height", "record-height", usual,
      Choices{{{720, "720"}, {1080, "1080"}, {1440, "1440"}, {2160, "4K"}}},
      "Of the pictures, in pixels, as wide as a screen: 16:9");
  if (usual != 0 && usual != choice.height) {
    choice.height = usual;
    choice.width = width_of(usual);
  }
  const float side = std::floor((record_label("Pixels") - pen.px(18)) / 2);
  const auto pixels = [&](const char* name, int& value) {
    double number = value;
    ImGui::SetNextItemWidth(side);
    if (number_field(pen, name, number, "%.0f", panels.drafts_.number))
      value = std::clamp(static_cast<int>(std::lround(std::clamp(number, 0.0, 1e6))),
                         least_picture_px, most_picture_px);
    tooltip(pen,
            "Any width and height, 16 to 8192 pixels; times Finer, as far as the graphics driver "
            "draws: Record tells of too many");
  };
  pixels("record-width", choice.width);
  ImGui::SameLine(0, pen.px(5));
  ImGui::AlignTextToFramePadding();
  text(theme.small, palette().text_dim, "\u00d7");
  ImGui::SameLine(0, pen.px(5));
  pixels("record-tall", choice.height);
  row("Per second", "record-rate", choice.frames_per_second,
      Choices{{{10, "10"}, {24, "24"}, {30, "30"}, {60, "60"}}},
      "Pictures for each second of the motion");
  row("Finer", "record-finer", choice.supersampling,
      Choices{{{1, "1x"}, {2, "2x"}, {3, "3x"}, {4, "4x"}}},
      "Supersampling: draws so many times as wide and high, then averages. The finest lines and "
      "edges, in more time. At 1x edges are as chosen below");
  int edges = static_cast<int>(choice.edges);
  row("Edges", "record-edges", edges,
      std::array<std::pair<int, const char*>, 3>{{{0, "MSAA"}, {1, "FXAA"}, {2, "Hard"}}},
      "Smooth by four samples a pixel (best; a driver that gives fewer is told of), by a filter "
      "over the finished picture (quick), or not at all");
  choice.edges = static_cast<RecordEdges>(edges);
  record_cameras();
  text_field(pen, "record-caption", choice.caption, record_label("Caption"),
             "Opening {opening} mm");
  tooltip(
      pen,
      "Words under the picture. Filled in: {time} in s, {opening} in mm (how far the lower "
      "incisal point has dropped), {interincisal} in mm (between the incisal edges), {rotation} "
      "in \u00b0, {motion}, {frame}. A | begins a new line");
  const double duration = input.scene.duration_s;
  const long frames = std::lround(duration * choice.frames_per_second) + 1;
  tick_box(pen, "record-transparent", "No background", choice.transparent);
  tooltip(pen,
          "PNG pictures with a transparent background, to lay over others; in a film it is black");
  ImGui::SameLine(std::floor(whole * 0.56f));
  tick_box(pen, "record-film", "Film (MP4)", choice.film);
  tooltip(pen, "Beside the pictures; made by the program ffmpeg when the last picture is there");
  // The next recording has a folder of its own, unless the person names one or is asked about it.
  if (fields.running && !input.recording && !panels.question()) fields.folder.clear();
  fields.running = input.recording;
  if (fields.folder.empty()) fields.folder = next_recording_folder(input.picture_folder).string();
  text_field(pen, "record-folder", fields.folder, record_label("Folder"), "where the pictures go");
  tooltip(pen, fields.folder.c_str());
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(6));
  if (input.recording) {
    const float done = static_cast<float>(input.recording_fraction);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(at, {at.x + whole, at.y + pen.px(6)}, palette().track, pen.px(3));
    list.AddRectFilled(at, {at.x + whole * done, at.y + pen.px(6)}, palette().accent, pen.px(3));
    ImGui::Dummy({whole, pen.px(8)});
    pen.mark("record-progress");
    text(theme.small, palette().text, fitted(theme.small, input.recording_what, whole));
    if (word_button(pen, "record-cancel", "Stop recording", {whole, pen.px(32)}, false))
      panels.wishes_.emplace_back(wish::StopRecording{});
    tooltip(pen, "The pictures made so far stay in the folder; the recording can be resumed");
  } else {
    const std::size_t cameras = choice.wanted_cameras().size();
    ImGui::BeginDisabled(duration <= 0 || fields.folder.empty() || cameras == 0);
    if (word_button(pen, "record", "Record", {whole, pen.px(32)}, true)) {
      wish::Record wanted{.folder = fields.folder,
                          .width = choice.width,
                          .height = choice.height,
                          .frames_per_second = choice.frames_per_second,
                          .film = choice.film,
                          .cameras = choice.wanted_cameras(),
                          .caption = choice.caption,
                          .transparent = choice.transparent,
                          .supersampling = choice.supersampling,
                          .edges = choice.edges,
                          .camera = input.camera,
                          .picture = {}};
      panels.wishes_.push_back(std::move(wanted));
    }
    ImGui::EndDisabled();
    text(theme.small, palette().text_dim,
         duration > 0
             ? fmt::format("{} pictures{} of {:.2f} s", frames,
                           cameras > 1 ? fmt::format(" from each of {} cameras", cameras) : "",
                           duration)
             : std::string("There is no motion to record"));
  }
  ImGui::PopStyleVar();
  ImGui::PushTextWrapPos(0);
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(4));
  if (input.unfinished.empty() || input.recording) {
    text(theme.small, palette().text_dim,
         "Pictures are drawn in full quality beside the window, which stays usable. They show what "
         "the view shows now, bones moved by hand and its light or dark background (T) included.");
  } else {
    text(theme.small, palette().text, input.unfinished);
    if (word_button(pen, "record-resume", "Resume this recording", {whole, high}, false))
      panels.wishes_.emplace_back(wish::ResumeRecording{});
    tooltip(pen,
            "Draws the pictures that are missing as the recording was begun, whatever the view "
            "shows now. It ends with the same bits as if it had never been stopped");
  }
  ImGui::PopTextWrapPos();
}

}  // namespace condyle
