#pragma once

#include <Eigen/Core>

#include "sim/anatomy_fit/anatomy_fit.h"

namespace condyle {

/// Moves stomion, both cheilia and the labralia to the line between the lips, the deepest hollow of
/// the skin's profile near the edge of the upper incisors, where the carried ones lie more than
/// 2.5 mm above or below it. Where the line ends early, a corner moves up or down with it alone and
/// becomes doubtful. `axes`: of the head, as columns: left, back, up. Without a hollow
/// there, the landmarks stay; they become doubtful where they are far from the incisors.
void find_mouth_line(std::map<std::string, ProposedLandmark>& marks, const TriMesh& skin,
                     const Eigen::Matrix3d& axes);

}  // namespace condyle
