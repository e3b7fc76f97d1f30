#include "sim/session/motion_settings.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace condyle {
namespace {

/// A parameter as the panel shows it: the published range of adults, and the value used where
/// neither the case nor the user states one (none: it follows from the patient's joints and teeth).
struct ShownParameter {
  const char* name;
  const char* label;
  double default_low, default_high;
  std::optional<double> default_value = std::nullopt;
};
constexpr std::array shown_parameters = {
    // The descent of an incisal point that moves 42 to 58 mm, forward and down as in Posselt's
    // diagram.
    ShownParameter{"opening", "Max. opening (drop)", 38, 52},
    ShownParameter{"protrusion", "Protrusion", 6, 11, 8},
    ShownParameter{"laterotrusion", "Laterotrusion", 7, 12, 9},
    ShownParameter{"retrusion", "Retrusion", 0.3, 1.4, 0.7},
    ShownParameter{"freeway", "Freeway space at rest", 2, 3, 2.5},
    ShownParameter{"hinge", "Hinge before translation", 0, 20, 12},
    ShownParameter{"inclination_left", "Condylar inclination, L", 26, 62},
    ShownParameter{"inclination_right", "Condylar inclination, R", 26, 62},
    ShownParameter{"bennett", "Bennett angle", 5, 15, 7.5},
    ShownParameter{"side_shift", "Immediate side shift", 0, 0.75, 0.3},
    ShownParameter{"disc_gap", "Condyle to fossa", 0, 0},
    ShownParameter{"speed", "Speed at the incisors", 0, 0, 40},
    ShownParameter{"chew_rate", "Chewing cycles a second", 1.2, 1.7, 1.4},
    ShownParameter{"chew_size", "Height of a chewing cycle", 0, 0, 15},
    ShownParameter{"chew_width", "Width of a chewing cycle", 0, 0, 5},
};

}  // namespace

std::vector<MotionSetting> motion_settings(const MotionChoice& choice, const Motion& motion,
                                           const MotionParameters& of_case, double widest_mm) {
  if (motion.recorded) return {};
  std::vector<MotionSetting> settings;
  for (const ShownParameter& shown : shown_parameters) {
    const auto* parameter = motion_parameter(shown.name);
    if (!parameter || parameter->values.empty()) continue;
    MotionSetting one{
        .name = shown.name,
        .label = shown.label,
        .unit = parameter->unit == "mm_s"  ? "mm/s"
                : parameter->unit == "hz"  ? "Hz"
                : parameter->unit == "deg" ? "\u00b0"
                                           : parameter->unit,
        .help = parameter->help,
        .low = parameter->low,
        .high = std::min(parameter->high, std::string_view(shown.name) == "speed" ? 200.0 : 80.0),
        .default_low = shown.default_low,
        .default_high = shown.default_high,
        .value = shown.default_value.value_or(0),
        .known = shown.default_value.has_value()};
    const auto say = [&](double value) {
      one.value = value;
      one.known = true;
    };
    if (one.name == "opening" && choice.spec == "opening") say(widest_mm);
    for (const MotionInput& found : motion.found)
      if (found.name == one.name) one.patients = found.value;
    if (const auto& value = of_case.*(parameter->values.front())) say(*value);
    for (const MotionInput& input : motion.inputs)
      if (input.name == one.name) say(input.value);
    if (const auto mine = choice.parameters.find(one.name); mine != choice.parameters.end())
      say(mine->second);
    settings.push_back(std::move(one));
  }
  return settings;
}

}  // namespace condyle
