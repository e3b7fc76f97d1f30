#pragma once

#include "engine/math/pose.h"
#include "sim/case/case.h"
#include "sim/frame/measures.h"

namespace condyle {

/// What a clinician reads off the mandible at X_CM. Uses the landmarks lower_incisal_point,
/// upper_incisal_point, left_condyle and right_condyle; a point without its landmark stays at the
/// origin and a length that needs one is 0.
Measures measure(const Case& patient, const Pose& X_CM);

}  // namespace condyle
