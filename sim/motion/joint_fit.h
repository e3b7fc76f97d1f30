#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/motion/motion.h"

namespace condyle {

/// What an articulator would be set to, to move as a motion does. A part is absent where the motion
/// does not show it.
struct JointFit {
  struct Side {
    // Secant of the condyle's path over its first 5 mm forward, to the Frankfort plane where porion
    // and orbitale are known, else to the horizontal.
    std::optional<double> inclination_deg;
    // Of the orbiting condyle's path to the sagittal plane, seen from above, past the immediate
    // side shift: medial = shift (1 - exp(-forward / 1 mm)) + forward tan(angle).
    std::optional<double> bennett_deg, side_shift_mm;
    double travel_mm = 0;  // farthest forward
  };
  Side left, right;
  // Turned before the condyles go forward, and then for each mm forward.
  std::optional<double> hinge_deg, deg_per_mm;
  bool to_frankfort = false;
};

/// Slope of the Frankfort plane in the case's frame, rad: how much higher porion lies than
/// orbitale. Absent without both.
std::optional<double> frankfort_slope(const Case& patient);

/// Least squares over the rows of a recording (or 200 moments of another motion). Needs both
/// condyles' landmarks; absent without.
std::optional<JointFit> fit_joint(const Case& patient, const Motion& motion);

/// The same as sentences.
std::vector<std::string> describe(const JointFit& fit);

}  // namespace condyle
