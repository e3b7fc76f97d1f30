#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "render/window/panels/panels_drawing.h"
#include "render/window/view/playback.h"

namespace condyle {
namespace {

// Ticks below the scrub bar at a round step, at most twelve.
void draw_ticks(const Pen& pen, ImVec2 low, float width, float y, double duration_s) {
  if (duration_s <= 0) return;
  double step = 0.1;
  for (const double factor : {2.0, 2.5, 2.0, 2.0, 2.5, 2.0, 2.0, 2.5})
    if (duration_s / step > 12) step *= factor;
  const float knob = pen.px(6.5f), span = width - 2 * knob;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  ImFont* font = pen.theme.small;
  for (int i = 0; i * step <= duration_s + 1e-9; ++i) {
    const float x = low.x + knob + span * static_cast<float>(i * step / duration_s);
    list.AddLine({x, y}, {x, y + pen.px(4)}, palette().text_faint, std::max(1.0f, pen.px(1)));
    const std::string label = fmt::format("{:g}", i * step);
    list.AddText(font, font->FontSize, {x - text_width(font, label) / 2, y + pen.px(5)},
                 palette().text_faint, label.c_str());
  }
}

}  // namespace

void Panels::Drawing::timeline() {
  const Theme& theme = panels.theme_;
  const double duration = input.scene.duration_s;
  begin_panel(pen, "bottom", layout.bottom);
  const float side = pen.px(34), gap = pen.px(4), row = pen.px(10);
  const float text_y = row + (side - theme.regular->FontSize) / 2;
  const float slider_y = row + (side - ImGui::GetFrameHeight()) / 2;

  ImGui::BeginDisabled(duration <= 0);
  ImGui::SetCursorPos({pen.px(14), row});
  if (sign_button(pen, "to-start", Sign::to_start, {side, side}, palette().field))
    seek(view, 0, duration, panels.X_CM_);
  tooltip(pen, "To the beginning");
  ImGui::SameLine(0, gap);
  if (sign_button(pen, "step-back", Sign::step_back, {side, side}, palette().field))
    panels.run(Command::step_back, input.scene, view);
  tooltip(pen, "A step back. Left arrow; ten with Shift");
  ImGui::SameLine(0, gap);
  if (sign_button(pen, "play", view.playing ? Sign::pause : Sign::play, {side * 1.5f, side},
                  palette().accent_dark))
    toggle_playing(view, duration, panels.X_CM_);
  tooltip(pen, view.playing ? "Pause. Space" : "Play. Space");
  ImGui::SameLine(0, gap);
  if (sign_button(pen, "step-forward", Sign::step_forward, {side, side}, palette().field))
    panels.run(Command::step_forward, input.scene, view);
  tooltip(pen, "A step forward. Right arrow; ten with Shift");
  ImGui::SameLine(0, gap);
  if (sign_button(pen, "loop", Sign::loop, {side, side},
                  view.loop ? palette().accent_dark : palette().field))
    view.loop = !view.loop;
  tooltip(pen, view.loop ? "Plays again and again" : "Stops at the end");
  ImGui::SameLine(0, pen.px(16));

  ImGui::SetCursorPosY(text_y);
  const std::string now = fmt::format("{:.2f}", view.time_s);
  const float time_x = ImGui::GetCursorPosX(), time_width = text_width(theme.bold, "00.00");
  ImGui::SetCursorPosX(time_x + std::max(0.0f, time_width - text_width(theme.bold, now)));
  text(theme.bold, palette().text, now);
  ImGui::SameLine(0, pen.px(5));
  text(theme.regular, palette().text_dim, fmt::format("of {:.2f} s", duration));

  // The scrub bar takes the width left of the speed control.
  ImGui::SameLine(0, pen.px(14));
  const float speed_width = pen.px(96), speed_label = text_width(theme.regular, "0.00\u00d7");
  const float end = static_cast<float>(layout.bottom.width) - pen.px(14);
  const float speed_title = text_width(theme.small, "Speed");
  const float speed_x = end - speed_label - pen.px(10) - speed_width - pen.px(8) - speed_title;
  const float scrub_x = ImGui::GetCursorPosX();
  const float scrub_width = std::max(pen.px(60), speed_x - scrub_x - pen.px(22));
  ImGui::SetCursorPosY(slider_y);
  const ImVec2 scrub_at = ImGui::GetCursorScreenPos();
  double time = view.time_s;
  if (slider(pen, "scrub", time, {.high = std::max(duration, 1e-9), .width = scrub_width})) {
    view.playing = false;
    seek(view, time, duration, panels.X_CM_);
  }
  draw_ticks(pen, scrub_at, scrub_width, scrub_at.y + ImGui::GetFrameHeight() / 2 + pen.px(9),
             duration);

  ImGui::SetCursorPos({speed_x, row + (side - theme.small->FontSize) / 2});
  text(theme.small, palette().text_dim, "Speed");
  ImGui::SetCursorPos({speed_x + speed_title + pen.px(8), slider_y});
  if (slider(pen, "speed", view.speed,
             {.low = 0.1, .high = 2, .width = speed_width, .logarithmic = true, .filled = false})) {
    // Snaps to real time.
    if (std::abs(std::log(view.speed)) < 0.06) view.speed = 1;
  }
  tooltip(pen, "0.1 to 2 times real time");
  ImGui::SetCursorPos({end - speed_label, text_y});
  text(theme.regular, palette().text, fmt::format("{:.2f}\u00d7", view.speed));
  ImGui::EndDisabled();

  // The foot: status, and the intended use.
  const float foot = static_cast<float>(layout.bottom.height) - theme.small->FontSize - pen.px(9);
  const float purpose_width = text_width(theme.small, purpose);
  std::string message = !panels.said_.empty() ? panels.said_ : input.loop.message;
  ImU32 tint = palette().text_dim;
  if (message.empty() && input.frame && input.frame->stopped) {
    message = "Stopped at the contact: the bones cannot follow the motion any further";
    tint = palette().warning;
  }
  ImGui::SetCursorPos({pen.px(14), foot});
  text(theme.small, tint, fitted(theme.small, message, end - purpose_width - pen.px(40)));
  ImGui::SetCursorPos({end - purpose_width, foot});
  text(theme.small, palette().text_dim, purpose);
  end_panel();
}

}  // namespace condyle
