#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace condyle {

/// How a patient's jaw moves, where it is not the usual way. From case.json ("motion"), a motion
/// file or the command line; what is not given is left to the patient's joints and teeth, or to
/// the usual values of adults.
struct MotionParameters {
  using Value = std::optional<double>;
  Value opening_mm = {};         // drop of the incisal point at maximum opening
  Value protrusion_mm = {};      // of the incisal point, farthest
  Value retrusion_mm = {};       // of the condyles behind intercuspation, farthest
  Value laterotrusion_mm = {};   // of the incisal point, farthest
  Value freeway_mm = {};         // between the incisors' rest position and their bite
  Value hinge_deg = {};          // turned before the condyles go forward
  Value early_translation = {};  // 0 hinge first ... 1 translation from the start
  Value inclination_left_deg = {},
        inclination_right_deg = {};             // secant over 5 mm; in place of the fossa
  Value path_shape = {};                        // 0 straight ... 1 curved as an eminence is
  Value bennett_deg = {};                       // of the orbiting condyle's way, seen from above
  Value side_shift_mm = {};                     // immediate
  Value disc_gap_mm = {};                       // condyle to fossa when seated
  Value disc_gap_front_mm = {};                 // the same on the slope of the eminence
  Value bonwill_mm = {};                        // condyle to lower incisal point
  Value balkwill_deg = {};                      // Bonwill's triangle to the horizontal
  Value incisal_guidance_deg = {};              // of an incisal table
  Value speed_mm_s = {};                        // mean, of the incisal point
  Value chew_rate_hz = {};                      // cycles a second
  Value chew_size_mm = {}, chew_width_mm = {};  // of a cycle at the incisal point, down and aside
  Value chew_cycles = {};

  /// These, and where they are silent the others.
  MotionParameters over(const MotionParameters& others) const;
};

/// One of them as people name it.
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
/// By name or key; null when there is none.
const MotionParameterName* motion_parameter(const std::string& name);

}  // namespace condyle
