#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "render/window/panels/panels_drawing.h"
#include "render/window/view/playback.h"

namespace condyle {
namespace {

constexpr double step_budget_ms = 1000.0 / 60;
constexpr double default_high_mm = 58;  // upper limit for the largest interincisal distance
constexpr float bar_row = 16, curve_height = 22;  // at scale 1
constexpr const char* performance_group = "performance";
constexpr double deeper_mm = 0.02;  // overlap beyond rest above the tolerance of contact

// A line with a dim name at the left and a value at the right.
void reading(const Theme& theme, const std::string& name, const std::string& value,
             ImU32 tint = palette().text) {
  text(theme.regular, palette().text_dim, name);
  ImGui::SameLine();
  text_right(theme.regular, tint, value);
}

// Worse pairs first: deepest beyond rest, then touching, then nearest.
bool worse(const PairContact& a, const PairContact& b) {
  const double deep_a = std::max(0.0, a.depth_mm - a.rest_depth_mm);
  const double deep_b = std::max(0.0, b.depth_mm - b.rest_depth_mm);
  if (deep_a != deep_b) return deep_a > deep_b;
  if (a.touching != b.touching) return a.touching;
  return a.distance_mm < b.distance_mm;
}

bool has_landmarks(const WindowScene& scene, std::initializer_list<const char*> names) {
  return std::all_of(names.begin(), names.end(), [&](const char* name) {
    return std::any_of(scene.landmarks.begin(), scene.landmarks.end(),
                       [&](const Landmark& one) { return one.name == name; });
  });
}

std::string part_name(const WindowScene& scene, int index) {
  const auto i = static_cast<std::size_t>(index);
  return index >= 0 && i < scene.parts.size() ? display_name(scene.parts[i].name) : "?";
}

}  // namespace

void Panels::Drawing::side_tabs() {
  constexpr std::array<std::pair<SideTab, const char*>, 5> tabs = {{{SideTab::readings, "Readings"},
                                                                    {SideTab::motion, "Motion"},
                                                                    {SideTab::face, "Face"},
                                                                    {SideTab::plan, "Plan"},
                                                                    {SideTab::record, "Record"}}};
  const float gap = pen.px(4);
  float words = 0;
  for (const auto& [tab, label] : tabs) words += text_width(panels.theme_.regular, label);
  const float margin = std::floor((ImGui::GetContentRegionAvail().x - 4 * gap - words) / 5);
  for (const auto& [tab, label] : tabs) {
    if (tab != SideTab::readings) ImGui::SameLine(0, gap);
    if (word_button(pen, (std::string("tab:") + label).c_str(), label,
                    {text_width(panels.theme_.regular, label) + margin, pen.px(26)},
                    view.tab == tab))
      view.tab = tab;
  }
}

void Panels::Drawing::side() {
  begin_panel(pen, "right", layout.right);
  side_tabs();
  if (view.tab == SideTab::motion)
    motion();
  else if (view.tab == SideTab::face)
    face();
  else if (view.tab == SideTab::plan)
    plan();
  else if (view.tab == SideTab::record)
    record();
  else
    readings();
  end_panel();
}

void Panels::Drawing::readings() {
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 4));
  opening();
  // Contacts get the height left by tissue and performance.
  const float line = ImGui::GetTextLineHeightWithSpacing();
  const float head = pen.px(38);  // a heading with its line and spacing
  const bool has_tissue = input.frame && !input.frame->tissue.nodes.empty();
  const float times = unfolded(performance_group)
                          ? static_cast<float>(stage_names.size()) * pen.px(bar_row) +
                                pen.px(curve_height + 5) + (has_tissue ? line : 0)
                          : 0;
  const float below = (has_tissue ? head + 2 * line : 0) + head + times + line + pen.px(5);
  const float pairs = input.frame ? static_cast<float>(input.frame->contacts.pairs.size()) : 0;
  const float room = ImGui::GetContentRegionAvail().y - below - head;
  contacts(std::max(2 * line, std::min(room, std::max(1.0f, pairs) * line)));
  if (has_tissue) tissue();
  performance();
  ImGui::PopStyleVar();
}

void Panels::Drawing::opening() {
  const Theme& theme = panels.theme_;
  const bool held = view.opening_mm.has_value();
  const double live = input.frame ? input.frame->measures.opening_mm : 0;
  heading(pen, "Opening", held || view.jaw_is_held() ? "held by hand" : "from the motion");

  const float top = ImGui::GetCursorPosY();
  const bool known = input.frame && has_landmarks(input.scene, {"lower_incisal_point"});
  const std::string number = known ? fmt::format("{:.1f}", std::abs(live) < 0.05 ? 0 : live) : "-";
  text(theme.large, palette().text, number);
  const float after = ImGui::GetCursorPosY();
  ImGui::SetCursorPos(
      {ImGui::GetStyle().WindowPadding.x + text_width(theme.large, number) + pen.px(6),
       top + (theme.large->FontSize - theme.regular->FontSize) * 0.78f});
  text(theme.regular, palette().text_dim, "mm drop");
  pen.mark("opening-number", number);
  tooltip(pen,
          "Vertical displacement of the lower incisal point from the closed position. The point "
          "also moves back, so "
          "the distance between the incisal edges is different: see the interincisal distance "
          "below");
  if (held) {
    const float wide = pen.px(76), high = pen.px(26);
    ImGui::SetCursorPos({ImGui::GetWindowContentRegionMax().x - wide, top + pen.px(3)});
    if (word_button(pen, "release", "Release", {wide, high}, false)) view.opening_mm.reset();
    tooltip(pen, "Back to the motion");
  }
  ImGui::SetCursorPosY(after);
  opening_slider(live);
  opening_measures();
}

/// Slider with ticks; a mark shows the actual opening while the hand holds the jaw.
void Panels::Drawing::opening_slider(double live) {
  const Theme& theme = panels.theme_;
  const bool held = view.opening_mm.has_value();
  constexpr double min_mm = 1;  // of a range that a hand can follow
  const bool opens = input.scene.max_opening_mm >= min_mm;
  const double most = std::max(min_mm, input.scene.max_opening_mm);
  const float width = ImGui::GetContentRegionAvail().x, knob = pen.px(6.5f);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  double shown_mm = held ? *view.opening_mm : std::clamp(live, 0.0, most);
  ImGui::BeginDisabled(!opens);
  if (slider(pen, "opening", shown_mm, {.high = most, .width = width, .held = held})) {
    view.hands.release_jaw(panels.X_CM_);
    view.opening_mm = shown_mm;
    view.playing = false;
  }
  ImGui::EndDisabled();
  tooltip(pen, opens
                   ? "Drag to open the mouth by hand, as the patient opens it (as recorded, where "
                     "the motion is a recording) and as far: the drop of the lower incisal "
                     "point, mm. Ctrl+click to type a number"
                   : "Nothing to open along: the recorded motion keeps the mouth shut, or the "
                     "patient has no landmarks of condyles and lower incisal point");
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto x_of = [&](double mm) {
    return at.x + knob + (width - 2 * knob) * static_cast<float>(std::clamp(mm / most, 0.0, 1.0));
  };
  const float y = at.y + ImGui::GetFrameHeight() / 2 + pen.px(8);
  const double step = most > 80 ? 20 : 10;
  for (double mm = 0; mm <= most + 1e-9; mm += step) {
    const std::string label = fmt::format("{:g}", mm);
    list.AddLine({x_of(mm), y}, {x_of(mm), y + pen.px(4)}, palette().text_faint,
                 std::max(1.0f, pen.px(1)));
    list.AddText(theme.small, theme.small->FontSize,
                 {x_of(mm) - text_width(theme.small, label) / 2, y + pen.px(5)},
                 palette().text_faint, label.c_str());
  }
  if (held && input.frame) {
    const float x = x_of(live), r = pen.px(4);
    list.AddTriangleFilled({x, y - pen.px(1)}, {x - r, y + r * 1.5f}, {x + r, y + r * 1.5f},
                           palette().text);
  }
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(13));
}

void Panels::Drawing::opening_measures() {
  const Theme& theme = panels.theme_;
  const Measures none;
  const Measures& m = input.frame ? input.frame->measures : none;
  const Pose rest = input.frame ? input.frame->poses[view.hands.jaw].inverse() : Pose{};
  const double left = (m.left_condyle - rest * m.left_condyle).norm();
  const double right = (m.right_condyle - rest * m.right_condyle).norm();
  const auto needs = [&](const char* name, std::initializer_list<const char*> marks,
                         const std::string& value, const char* with, const char* without,
                         bool unusual = false) {
    const bool there = has_landmarks(input.scene, marks);
    reading(theme, name, there ? value : std::string("unknown"),
            !there    ? palette().text_faint
            : unusual ? palette().warning
                      : palette().text);
    pen.mark(std::string("reading:") + name, there ? value : "unknown");
    tooltip(pen, there ? with : without);
  };
  needs("Interincisal distance", {"upper_incisal_point", "lower_incisal_point"},
        fmt::format("{:.1f} mm", m.interincisal_mm),
        "From the upper to the lower incisal edge, as a ruler measures it in the mouth. The widest "
        "that adults open is 42 to 58 mm",
        "Needs the landmarks upper incisal point and lower incisal point: key B",
        m.interincisal_mm > default_high_mm);
  reading(theme, "Rotation", fmt::format("{:.1f}\u00b0", m.rotation_deg));
  needs("Condyle travel", {"left_condyle", "right_condyle"},
        fmt::format("L {:.1f}   R {:.1f} mm", left, right),
        "How far each condyle is from where it rests, straight",
        "Needs the landmarks left condyle and right condyle: key B");
}

void Panels::Drawing::contacts(float list_height) {
  const Theme& theme = panels.theme_;
  std::string summary;
  std::vector<PairContact const*> pairs;
  if (input.frame) {
    for (const PairContact& pair : input.frame->contacts.pairs) pairs.push_back(&pair);
    std::stable_sort(pairs.begin(), pairs.end(), [](auto a, auto b) { return worse(*a, *b); });
    const double deepest = input.frame->contacts.max_penetration_mm();
    const double clearance = input.frame->contacts.min_clearance_mm();
    if (input.frame->stopped)
      summary = "stopped";
    else if (deepest > deeper_mm)
      summary = fmt::format("{:.2f} mm too deep", deepest);
    else if (std::isfinite(clearance) && clearance > 0)
      summary = fmt::format("least {:.1f} mm", clearance);
  }
  heading(pen, "Contact", summary);
  ImGui::BeginChild("contact-list", {0, list_height});
  if (pairs.empty()) text(theme.regular, palette().text_faint, "No pairs to check");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairContact& pair = *pairs[i];
    const double deeper = pair.depth_mm - pair.rest_depth_mm;
    std::string value = fmt::format("{:.1f} mm", pair.distance_mm);
    ImU32 tint = pair.distance_mm < 2 ? palette().text : palette().text_dim;
    if (deeper > deeper_mm) {
      value = fmt::format("{:.2f} mm deep", deeper);
      tint = palette().bad;
    } else if (pair.touching) {
      value = pair.rest_depth_mm > deeper_mm ? "as at rest" : "touching";
      tint = palette().warning;
    }
    const float end = ImGui::GetContentRegionAvail().x, dot = pen.px(4);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 centre = {at.x + dot, at.y + theme.regular->FontSize / 2 + pen.px(1)};
    if (pair.touching) {
      list.AddCircleFilled(centre, dot, tint, 16);
    } else {
      list.AddCircle(centre, dot - pen.px(0.5f), palette().text_faint, 16, pen.px(1));
    }
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 2 * dot + pen.px(8));
    const float room = end - 2 * dot - pen.px(8) - text_width(theme.regular, value) - pen.px(10);
    const std::string both =
        part_name(input.scene, pair.part_a) + " / " + part_name(input.scene, pair.part_b);
    text(theme.regular, pair.touching ? palette().text : palette().text_dim,
         fitted(theme.regular, both, room));
    tooltip(pen, fmt::format(
                     "{}\nDistance {:.3f} mm, depth {:.3f} mm (at rest {:.3f} mm), {} contact {}",
                     both, pair.distance_mm, pair.depth_mm, pair.rest_depth_mm,
                     pair.contacts.size(), pair.contacts.size() == 1 ? "point" : "points")
                     .c_str());
    pen.mark(fmt::format("pair:{}", i));
    ImGui::SameLine();
    text_right(theme.regular, tint, value);
  }
  ImGui::EndChild();
}

void Panels::Drawing::tissue() {
  const Theme& theme = panels.theme_;
  const TissueState& state = input.frame->tissue;
  if (!view.simulates_tissue(input.scene)) {
    heading(pen, "Tissue", "waits");
    reading(theme, "Moves again when it is shown", "", palette().text);
    ImGui::NewLine();
    return;
  }
  heading(pen, "Tissue", fmt::format("{} nodes", state.nodes.size()));
  reading(theme, "Iterations",
          fmt::format("{}{}", state.iterations,
                      state.converged ? ""
                      : state.reused  ? ", failed: as before"
                                      : ", not settled"),
          state.reused ? palette().warning : palette().text);
  if (state.inverted_prisms)
    reading(theme, "Inverted prisms", fmt::format("{}", state.inverted_prisms), palette().bad);
  else
    ImGui::NewLine();
}

void Panels::Drawing::performance() {
  const Theme& theme = panels.theme_;
  StageTimes times = input.frame ? input.frame->times : StageTimes{};
  times[Stage::render] = input.pictures.picture_ms;
  double total = 0;
  for (std::size_t i = 0; i < times.ms.size(); ++i)
    if (static_cast<Stage>(i) != Stage::render) total += times.ms[i];
  heading(pen, "Performance", fmt::format("{:.1f} ms a step", total));

  const bool open = unfolded(performance_group);
  const float y = ImGui::GetCursorPosY();
  if (fold(pen, "group:performance", open)) fold_group(performance_group);
  tooltip(pen, open ? "Hide the times of each stage" : "Show the times of each stage of a step");
  ImGui::SameLine(0, 0);
  ImGui::SetCursorPosY(y + (ImGui::GetFrameHeight() - theme.small->FontSize) / 2);
  const double pictures = input.pictures.pictures_per_second;
  const bool runs = view.playing || view.falling || pictures > 0;
  std::string rates = "at rest";
  if (runs) rates = fmt::format("{:.0f} steps/s", input.loop.steps_per_second);
  if (pictures > 0) rates += fmt::format(", {:.0f} pictures/s", pictures);
  text(theme.small, palette().text_dim, rates);
  pen.mark("rates", rates);
  if (input.pictures.render_scale < 1 || input.pictures.samples < 4) {
    ImGui::SameLine();
    const bool limited = input.pictures.finished;
    const std::string words =
        limited ? "limited by the driver"
        : input.pictures.render_scale < 1
            ? fmt::format("preview {:.0f} %", 100 * input.pictures.render_scale)
            : "preview";
    text_right(theme.small, palette().text_faint, words);
    pen.mark("quality", words);
    tooltip(pen,
            limited ? "The graphics driver offers too few samples per pixel for fully smooth edges"
                    : "On a slow machine the picture is drawn at a lower resolution during motion, "
                      "and at full resolution at rest");
  }
  if (!open) return;
  if (input.frame && view.simulates_tissue(input.scene) && !input.frame->tissue.nodes.empty())
    reading(theme, "Tissue residual", fmt::format("{:.1e} N", input.frame->tissue.residual));
  stage_bars(times, std::max({step_budget_ms, total, times[Stage::render]}));
  step_curve();
}

void Panels::Drawing::stage_bars(const StageTimes& times, double full_ms) {
  const Theme& theme = panels.theme_;
  const float width = ImGui::GetContentRegionAvail().x;
  const float name_width = text_width(theme.small, "measures") + pen.px(10);
  const float value_width = text_width(theme.small, "0000.0 ms") + pen.px(4);
  const float bar = width - name_width - value_width;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (std::size_t i = 0; i < stage_names.size(); ++i) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool picture = static_cast<Stage>(i) == Stage::render;
    const float text_y = at.y + (pen.px(bar_row) - theme.small->FontSize) / 2,
                mid = at.y + pen.px(bar_row / 2);
    const std::string name = picture ? "picture" : std::string(stage_names[i]);
    const std::string value = times.ms[i] < 1000 ? fmt::format("{:.1f} ms", times.ms[i])
                                                 : fmt::format("{:.1f} s", times.ms[i] / 1000);
    list.AddText(theme.small, theme.small->FontSize, {at.x, text_y}, palette().text_dim,
                 name.c_str());
    list.AddRectFilled({at.x + name_width, mid - pen.px(3)},
                       {at.x + name_width + bar, mid + pen.px(3)}, palette().field, pen.px(3));
    const float fill = bar * static_cast<float>(std::clamp(times.ms[i] / full_ms, 0.0, 1.0));
    if (fill > 0.5f)
      list.AddRectFilled({at.x + name_width, mid - pen.px(3)},
                         {at.x + name_width + std::max(fill, pen.px(3)), mid + pen.px(3)},
                         picture ? palette().text_faint : palette().accent, pen.px(3));
    list.AddText(theme.small, theme.small->FontSize,
                 {at.x + width - text_width(theme.small, value), text_y}, palette().text,
                 value.c_str());
    ImGui::Dummy({width, pen.px(bar_row) - ImGui::GetStyle().ItemSpacing.y});
  }
}

/// The durations of the last steps as a curve; a line marks the duration at 60 steps a second.
void Panels::Drawing::step_curve() {
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(4));
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, curve = pen.px(curve_height);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(low, {low.x + width, low.y + curve}, palette().well, pen.px(3));
  const auto& history = panels.step_ms_;
  float highest = static_cast<float>(step_budget_ms) * 1.25f;
  for (const float ms : history) highest = std::max(highest, ms * 1.1f);
  const auto y_of = [&](float ms) { return low.y + curve - curve * ms / highest; };
  const float budget_y = y_of(static_cast<float>(step_budget_ms));
  list.AddLine({low.x, budget_y}, {low.x + width, budget_y}, palette().outline,
               std::max(1.0f, pen.px(1)));
  if (history.size() > 1) {
    std::vector<ImVec2> points;
    const float dx = width / 119.0f;
    for (std::size_t i = 0; i < history.size(); ++i)
      points.push_back(
          {low.x + width - dx * static_cast<float>(history.size() - 1 - i), y_of(history[i])});
    list.AddPolyline(points.data(), static_cast<int>(points.size()), palette().accent, 0,
                     std::max(1.0f, pen.px(1.3f)));
  }
  ImGui::Dummy({width, curve});
  pen.mark("curve");
}

}  // namespace condyle
