#pragma once

#include <map>
#include <optional>
#include <string>

namespace condyle {

/// The motion that the user chooses: the values that a command line would state.
struct MotionChoice {
  std::string spec;                           // a name, a file or movements in words
  std::map<std::string, double> parameters;   // by name, where they differ from the case's
  std::map<std::string, double> excitations;  // by group of muscles, where they are set by hand
  bool operator==(const MotionChoice&) const = default;
};

/// One parameter of the motion, as a front end shows it.
struct MotionSetting {
  std::string name, label, unit, help;
  double low = 0, high = 1;                  // accepted range
  double default_low = 0, default_high = 0;  // published band of adults; none when equal
  double value = 0;                          // in use
  bool known = true;                    // false: it follows from the patient's joints and teeth
  std::optional<double> patients = {};  // the value that follows
};

/// One group of muscles: 0 to 1 of its maximum, or a fraction of what the motion's file states.
struct ExcitationSetting {
  std::string name, label;
  double high = 1, value = 0;
};

}  // namespace condyle
