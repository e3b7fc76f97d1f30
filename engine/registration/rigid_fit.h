#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "engine/math/pose.h"

namespace condyle {

/// The pose X_BA that takes points of A to their partners in B with the least sum of squares.
/// shape: both n x 3, mm. Absent for fewer than three points, or points on a line.
/// source: Kabsch, Acta Crystallographica A32, 1976
std::optional<Pose> rigid_fit(std::span<const Eigen::Vector3d> p_A,
                              std::span<const Eigen::Vector3d> p_B);

}  // namespace condyle
