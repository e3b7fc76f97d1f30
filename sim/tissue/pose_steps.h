#pragma once

#include <span>
#include <vector>

#include "sim/tissue/model.h"

namespace condyle {

/// Intermediate poses of all bodies from those of one solve to those of the next, which come last.
/// There is one step unless a piece moves far relative to the bone that it was cut from, as when a
/// plan is made or undone: a bone that advances into tissue by many millimetres at once would leave
/// its points inside bone.
std::vector<std::vector<Pose>> pose_steps(const TissueModel& model, std::span<const Pose> X_CB_from,
                                          std::span<const Pose> X_CB_to);

}  // namespace condyle
