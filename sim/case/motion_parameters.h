#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace condyle {

/// Parameters of a patient's jaw motion, from case.json ("motion"), a motion script or the command
/// line. Values that are not given follow from the patient's joints and teeth, or are average
/// values of adults.
struct MotionParameters {
  using Value = std::optional<double>;
  Value opening_mm = {};         // descent of the incisal point at maximum opening
  Value protrusion_mm = {};      // maximum, at the incisal point
  Value retrusion_mm = {};       // maximum, of the condyles behind intercuspation
  Value laterotrusion_mm = {};   // maximum, at the incisal point
  Value freeway_mm = {};         // incisal distance from the rest position to the bite
  Value hinge_deg = {};          // rotation before the condyles translate
  Value early_translation = {};  // 0 hinge first ... 1 translation from the start
  Value inclination_left_deg = {},
        inclination_right_deg = {};  // secant over 5 mm; replaces the fossa
  Value path_shape = {};             // 0 straight ... 1 curved as an eminence
  Value bennett_deg = {};            // of the orbiting condyle's path, horizontal plane
  Value side_shift_mm = {};          // immediate
  Value disc_gap_mm = {};            // condyle to fossa when seated
  Value disc_gap_front_mm = {};      // on the slope of the eminence
  Value bonwill_mm = {};             // condyle to lower incisal point
  Value balkwill_deg = {};           // Bonwill's triangle to the horizontal
  Value incisal_guidance_deg = {};   // of an incisal table
  Value speed_mm_s = {};             // mean, of the incisal point
  Value chew_rate_hz = {};           // cycles per second
  Value chew_size_mm = {},
        chew_width_mm = {};  // of a cycle at the incisal point, vertical and lateral
  Value chew_cycles = {};

  /// These values; where absent, those of the other parameters.
  MotionParameters over(const MotionParameters& others) const;
};

/// A parameter with its public name.
struct MotionParameterName {
  std::string name;  // "bennett"; on the command line with '-' for '_'
  std::string unit;  // "deg", "mm", ...; empty for a plain number
  double low = 0, high = 0;
  std::string help;
  std::vector<MotionParameters::Value MotionParameters::*> values;

  /// Name and unit, as in case.json: "bennett_deg".
  std::string key() const { return unit.empty() ? name : name + "_" + unit; }
};

std::span<const MotionParameterName> motion_parameter_names();
/// The parameter of that name or key; null if there is none.
const MotionParameterName* motion_parameter(const std::string& name);

}  // namespace condyle
