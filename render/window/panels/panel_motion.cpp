#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

/// Percentages are set and shown to a tenth.
double tenths(double percent) { return std::round(10 * percent) / 10; }

/// A named number with its unit, and its published range as a bar below the slider.
struct Setting {
  std::string item, label, unit, help;
  double low, high, default_low = 0, default_high = 0;
  bool known = true;
  std::optional<double> patients = {};  // value from the patient while none is set
};

/// Returns true when a changed value is released.
bool setting_slider(Pen& pen, const Setting& setting, std::map<std::string, double>& edited,
                    const std::string& name, double& value, bool set_by_hand) {
  const auto draft = edited.find(name);
  const bool known = setting.known || draft != edited.end();
  // A value from the patient's own joints has no fill; where it is unknown, the middle of
  // the published range is shown.
  const double middle = setting.default_low < setting.default_high
                            ? (setting.default_low + setting.default_high) / 2
                            : setting.low;
  const double start = known ? value : setting.patients.value_or(middle);
  double shown = draft != edited.end() ? draft->second : start;
  const bool has_number = known || setting.patients;
  const bool unusual = has_number && setting.default_low < setting.default_high &&
                       (shown < setting.default_low - 1e-9 || shown > setting.default_high + 1e-9);
  const std::string unit =
      setting.unit == "\u00b0" || setting.unit.empty() ? setting.unit : " " + setting.unit;
  const std::string number = !has_number ? std::string()
                             : setting.unit == "%"
                                 ? fmt::format("{:g}{}", tenths(shown), unit)
                                 : fmt::format("{:.{}g}{}", shown, known ? 4 : 3, unit);
  text(pen.theme.regular, set_by_hand ? palette().text : palette().text_dim, setting.label);
  ImGui::SameLine();
  const float right = ImGui::GetWindowContentRegionMax().x;
  if (!known) {
    const std::string whose = has_number ? "patient's" : "the patient's";
    const float number_width =
        has_number ? text_width(pen.theme.regular, number) + pen.px(5) : 0.0f;
    const float y = ImGui::GetCursorPosY();
    ImGui::SetCursorPos({right - number_width - text_width(pen.theme.small, whose),
                         y + (pen.theme.regular->FontSize - pen.theme.small->FontSize) * 0.7f});
    text(pen.theme.small, palette().text_dim, whose);
    ImGui::SameLine();
    ImGui::SetCursorPosY(y);
  }
  text_right(pen.theme.regular, unusual ? palette().warning : palette().text, number);
  pen.mark("number:" + name, number);
  const float width = ImGui::GetContentRegionAvail().x;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (setting.default_low < setting.default_high) {
    const float knob = pen.px(6.5f), span = width - 2 * knob;
    const auto x = [&](double v) {
      return at.x + knob +
             span * static_cast<float>((v - setting.low) / (setting.high - setting.low));
    };
    const float y = at.y + ImGui::GetFrameHeight() / 2 + pen.px(7);
    ImGui::GetWindowDrawList()->AddRectFilled({x(setting.default_low), y},
                                              {x(setting.default_high), y + pen.px(3)},
                                              palette().good, pen.px(1));
  }
  if (slider(pen, setting.item.c_str(), shown,
             {.low = setting.low, .high = setting.high, .width = width, .filled = known}))
    edited[name] = shown;
  const bool released = ImGui::IsItemDeactivated();
  std::string help = setting.help;
  if (setting.default_low < setting.default_high)
    help += fmt::format("\nPublished for adults: {:g} to {:g}{}", setting.default_low,
                        setting.default_high, unit);
  help += "\nCtrl+click to type a number";
  tooltip(pen, help.c_str());
  if (!released || !edited.count(name)) return false;
  value = edited[name];
  edited.erase(name);
  return true;
}

}  // namespace

void Panels::Drawing::motion() {
  heading(pen, "Motion", motion_title(input.scene));
  motion_choice();
  if (!input.scene.excitations.empty()) motion_muscles();
  if (!input.scene.motion_settings.empty()) motion_parameters();
}

/// Choice of a built-in motion, or of one written as a script.
void Panels::Drawing::motion_choice() {
  PanelFormState& form = panels.form_;
  const std::string now = view.motion.spec;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const bool named = std::find(input.scene.motions.begin(), input.scene.motions.end(), now) !=
                     input.scene.motions.end();
  if (ImGui::BeginCombo("##motion", named ? display_name(now).c_str() : "In words or from a file",
                        ImGuiComboFlags_HeightLarge)) {
    for (const std::string& name : input.scene.motions) {
      if (ImGui::Selectable(display_name(name).c_str(), name == now)) {
        view.motion = {.spec = name, .parameters = view.motion.parameters, .excitations = {}};
        form.motion_words.clear();
      }
      pen.mark("motion:" + name);
    }
    ImGui::EndCombo();
  }
  pen.mark("motion");
  tooltip(pen, "Motions that come with the program");
  if (text_field(pen, "motion-words", form.motion_words, ImGui::GetContentRegionAvail().x,
                 "open 40; close; left 6") &&
      !form.motion_words.empty()) {
    view.motion = {
        .spec = form.motion_words, .parameters = view.motion.parameters, .excitations = {}};
  }
  tooltip(
      pen,
      "A motion in words; Enter plays it. open 40 over 1.5; close; hinge 10; protrude 6; retrude; "
      "left 8; right 8; rest; hold 0.5; posselt; chew left 10; smile 0.8. Lengths in mm, times in "
      "s. "
      "A motion file can be dropped on the window");
}

void Panels::Drawing::motion_muscles() {
  PanelFormState& form = panels.form_;
  heading(pen, "Muscles", "excitation");
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 1));
  const float row = 2 * ImGui::GetFrameHeight();
  const float needed = row * static_cast<float>(input.scene.excitations.size());
  const float most = input.scene.motion_settings.empty()
                         ? ImGui::GetContentRegionAvail().y - pen.px(4)
                         : 0.5f * ImGui::GetContentRegionAvail().y;
  ImGui::BeginChild("muscle-list", {0, std::min(needed, most)});
  for (const ExcitationSetting& muscle : input.scene.excitations) {
    const auto mine = view.motion.excitations.find(muscle.name);
    double value = mine != view.motion.excitations.end() ? mine->second : muscle.value;
    double percent = 100 * value;
    const Setting setting{"excitation:" + muscle.name,
                          muscle.label,
                          "%",
                          muscle.high > 1 ? "Percentage of the value in the motion's file"
                                          : "How much the muscle is excited while it lasts",
                          0,
                          100 * muscle.high};
    if (setting_slider(pen, setting, form.excitations, muscle.name, percent,
                       mine != view.motion.excitations.end())) {
      view.motion.excitations[muscle.name] = tenths(percent) / 100;
    }
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

void Panels::Drawing::motion_parameters() {
  PanelFormState& form = panels.form_;
  heading(pen, "Parameters", "published range in green");
  const float foot = pen.px(34);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 1));
  ImGui::BeginChild("parameter-list",
                    {0, std::max(pen.px(60), ImGui::GetContentRegionAvail().y - foot)});
  for (const MotionSetting& one : input.scene.motion_settings) {
    const auto mine = view.motion.parameters.find(one.name);
    const bool by_hand = mine != view.motion.parameters.end();
    double value = by_hand ? mine->second : one.value;
    const Setting setting{"parameter:" + one.name,
                          one.label,
                          one.unit,
                          one.help,
                          one.low,
                          one.high,
                          one.default_low,
                          one.default_high,
                          one.known || by_hand,
                          one.patients};
    if (setting_slider(pen, setting, form.parameters, one.name, value, by_hand)) {
      view.motion.parameters[one.name] = value;
    }
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
  ImGui::BeginDisabled(view.motion.parameters.empty());
  if (word_button(pen, "parameters-reset", "Reset to patient",
                  {ImGui::GetContentRegionAvail().x, pen.px(26)}, false)) {
    view.motion.parameters.clear();
  }
  ImGui::EndDisabled();
  tooltip(pen, "All parameters as the patient's joints, teeth and case say");
}

}  // namespace condyle
