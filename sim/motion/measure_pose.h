#pragma once

#include "sim/case/case.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/measures.h"

namespace condyle {

/// Clinical measures of the jaw with its bodies at these poses. Uses the landmarks
/// lower_incisal_point, upper_incisal_point, left_condyle and right_condyle; a point without its
/// landmark is the origin and a length that needs one is 0.
Measures measure(const Case& patient, const BodyPoses& at);

}  // namespace condyle
