#pragma once

#include <memory>

#include "sim/tissue/tissue.h"

namespace condyle {

/// The same tissue with a state of equilibrium as its rest, such as that of the planned patient:
/// poses, states and points of the face count from there, while springs stay as strained as they
/// are in `state`; muscles of the face have adapted to it. The opening path and its factors are
/// solved anew.
std::shared_ptr<const TissueModel> with_planned_rest(const TissueModel& model,
                                                     const TissueState& state, int threads = 1);

}  // namespace condyle
