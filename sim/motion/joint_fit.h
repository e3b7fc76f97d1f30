#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/motion/motion.h"

namespace condyle {

/// Articulator settings that reproduce a motion. A value that the motion does not determine is
/// absent.
struct JointFit {
  struct Side {
    // Secant of the condyle's path over its first 5 mm forward, to the Frankfort plane where porion
    // and orbitale are known, else to the horizontal.
    std::optional<double> inclination_deg;
    // Angle of the orbiting condyle's path to the sagittal plane, in the horizontal plane, after
    // the immediate side shift: medial = shift (1 - exp(-forward / 1 mm)) + forward tan(angle).
    std::optional<double> bennett_deg, side_shift_mm;
    double travel_mm = 0;  // maximum, forward
  };
  Side left, right;
  // Rotation before the condyles translate, and then per mm of forward travel.
  std::optional<double> hinge_deg, deg_per_mm;
  bool to_frankfort = false;
};

/// Slope of the Frankfort plane in the case's frame, rad; positive: porion above orbitale. Absent
/// without these landmarks.
std::optional<double> frankfort_slope(const Case& patient);

/// Least-squares fit over the rows of a recording (or 200 samples of another motion). Absent
/// without the landmarks of both condyles.
std::optional<JointFit> fit_joint(const Case& patient, const Motion& motion);

/// The fit as sentences.
std::vector<std::string> describe(const JointFit& fit);

}  // namespace condyle
