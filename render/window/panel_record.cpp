#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <cmath>

#include "render/window/panels_drawing.h"
#include "render/window/picture_files.h"

namespace condyle {

void Panels::Drawing::record() {
  const Theme& theme = panels.theme_;
  Drafts::RecordFields& fields = panels.drafts_.record;
  const float gap = pen.px(5), high = pen.px(28);
  const float whole = ImGui::GetContentRegionAvail().x;
  const auto share = [&](int n) {
    return std::floor((whole - gap * static_cast<float>(n - 1)) / static_cast<float>(n));
  };

  heading(pen, "Picture", "PNG");
  if (word_button(pen, "save-picture", "The view", {share(2), high}, false))
    commands.push_back(Command::picture);
  tooltip(pen, "Saves the 3-D picture in full quality. F12");
  ImGui::SameLine(0, gap);
  if (word_button(pen, "save-window", "The window", {share(2), high}, false))
    commands.push_back(Command::window_picture);
  tooltip(pen, "Saves the window with its panels. Shift+F12");

  heading(pen, "Recording", "the whole motion, from this view");
  text(theme.small, palette().text_dim, "Height in pixels, 16:9");
  constexpr std::array<std::pair<int, const char*>, 4> heights = {
      {{720, "720"}, {1080, "1080"}, {1440, "1440"}, {2160, "4K"}}};
  for (const auto& [pixels, label] : heights) {
    if (pixels != heights.front().first) ImGui::SameLine(0, gap);
    if (word_button(pen, fmt::format("record-height:{}", pixels).c_str(), label, {share(4), high},
                    fields.height == pixels))
      fields.height = pixels;
  }
  text(theme.small, palette().text_dim, "Pictures a second");
  for (const int rate : {10, 24, 30, 60}) {
    if (rate != 10) ImGui::SameLine(0, gap);
    if (word_button(pen, fmt::format("record-rate:{}", rate).c_str(),
                    fmt::format("{}", rate).c_str(), {share(4), high},
                    fields.frames_per_second == rate))
      fields.frames_per_second = rate;
  }
  const double duration = input.scene.duration_s;
  const long frames = std::lround(duration * fields.frames_per_second) + 1;
  tick_box(pen, "record-film", "Film (MP4) beside the pictures", fields.film);
  tooltip(pen, "Made by the program ffmpeg when the last picture is there");
  tick_box(pen, "record-turntable", "Turn once around the patient", fields.turntable);
  text(theme.small, palette().text_dim, "Folder");
  // The next recording has a folder of its own, unless the person names one.
  if (fields.running && !input.recording) fields.folder.clear();
  fields.running = input.recording;
  if (fields.folder.empty()) fields.folder = next_recording_folder(input.picture_folder).string();
  text_field(pen, "record-folder", fields.folder, whole, "where the pictures go");
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
      panels.wishes_.emplace_back(wish::Cancel{});
    tooltip(pen, "The pictures made so far stay in the folder");
  } else {
    ImGui::BeginDisabled(duration <= 0 || fields.folder.empty());
    if (word_button(pen, "record", "Record", {whole, pen.px(32)}, true)) {
      wish::Record wanted{.folder = fields.folder,
                          .width = static_cast<int>(std::lround(fields.height * 16 / 9.0)),
                          .height = fields.height,
                          .frames_per_second = fields.frames_per_second,
                          .film = fields.film,
                          .turntable = fields.turntable,
                          .camera = input.camera,
                          .picture = {}};
      panels.wishes_.push_back(std::move(wanted));
    }
    ImGui::EndDisabled();
    text(theme.small, palette().text_dim,
         duration > 0 ? fmt::format("{} pictures of {:.2f} s", frames, duration)
                      : std::string("There is no motion to record"));
  }
  ImGui::PushTextWrapPos(0);
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(8));
  text(theme.small, palette().text_dim,
       "Pictures are drawn in full quality beside the window, which stays usable. They show what "
       "the view shows now, bones moved by hand included.");
  ImGui::PopTextWrapPos();
}

}  // namespace condyle
