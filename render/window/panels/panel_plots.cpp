#include <imgui.h>

#include <algorithm>

#include "render/window/panels/panels_drawing.h"
#include "render/window/panels/plot_drawing.h"

namespace condyle {

/// Below the picture: tabs, and the panels of the selected set side by side.
void Panels::Drawing::plots() {
  if (layout.plots.height <= 0) return;
  const Theme& theme = panels.theme_;
  begin_panel(pen, "plots", layout.plots);
  const std::size_t sets = input.plots.size() + 1;  // and the stage times, which are in every frame
  // There are fewer while the plots of a new motion are computed; the selection is kept.
  const std::size_t chosen = std::min(view.plot_set, sets - 1);
  const float gap = pen.px(4), high = pen.px(24);
  for (std::size_t i = 0; i < sets; ++i) {
    const std::string name = i < input.plots.size() ? input.plots[i].name : "Stage times";
    const float wide = text_width(theme.regular, name) + pen.px(18);
    if (i > 0) ImGui::SameLine(0, gap);
    if (word_button(pen, ("plot-tab:" + name).c_str(), name.c_str(), {wide, high}, i == chosen))
      view.plot_set = i;
  }
  ImGui::SameLine();
  ImGui::SetCursorPosX(static_cast<float>(layout.plots.width) - pen.px(14) - high);
  if (sign_button(pen, "plots-close", Sign::close, {high, high}, palette().field))
    view.plots = false;
  tooltip(pen, "Put the plots away. Key G");

  const bool live = chosen >= input.plots.size();
  const PlotSet stage = live ? panels.stage_plots() : PlotSet{};
  const PlotSet& set = live ? stage : input.plots[chosen];
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (set.panels.empty() || set.panels.front().curves.empty() ||
      set.panels.front().curves.front().x.empty()) {
    text(theme.small, palette().text_dim,
         live ? "Nothing was simulated yet" : "The motion is being walked through");
  } else {
    const auto count = static_cast<float>(set.panels.size());
    const float between = pen.px(14);
    const float wide = (room.x - between * (count - 1)) / count;
    const double now_s = live && !set.time_s.empty() ? set.time_s.back()
                         : input.frame               ? input.frame->time_s
                                                     : view.time_s;
    for (std::size_t i = 0; i < set.panels.size(); ++i)
      draw_plot(pen, set.panels[i], set.time_s, now_s,
                {at.x + static_cast<float>(i) * (wide + between), at.y + pen.px(2), wide,
                 room.y - pen.px(2)});
  }
  end_panel();
}

/// Times of the stages of the last steps.
PlotSet Panels::stage_plots() const {
  PlotPanel panel{{},
                  {.title = "Stage times of the last steps",
                   .x_label = "steps ago",
                   .y_label = "ms",
                   .levels = {{"60 steps a second: 16.7 ms", 1000.0 / 60}},
                   .x_goes_back = true}};
  const auto total = static_cast<double>(stage_ms_.size());
  for (std::size_t stage = 0; stage < stage_names.size(); ++stage) {
    if (static_cast<Stage>(stage) == Stage::render) continue;
    Curve curve{std::string(stage_names[stage]), {}, {}};
    double most = 0;
    for (std::size_t i = 0; i < stage_ms_.size(); ++i) {
      curve.x.push_back(static_cast<double>(i) + 1 - total);
      curve.y.push_back(stage_ms_[i][stage]);
      most = std::max(most, curve.y.back());
    }
    if (most > 0.05) panel.curves.push_back(std::move(curve));
  }
  PlotSet set{"Stage times", {std::move(panel)}, {}};
  return set;
}

}  // namespace condyle
