#pragma once

#include <vector>

#include "sim/case/case.h"
#include "sim/choice/motion_choice.h"
#include "sim/motion/motion.h"

namespace condyle {

/// The parameters of a motion and the source of each; none for a recorded one. `widest_mm`:
/// the largest opening along the patient's opening movement.
std::vector<MotionSetting> motion_settings(const MotionChoice& choice, const Motion& motion,
                                           const MotionParameters& of_case, double widest_mm);

}  // namespace condyle
