#pragma once

#include <Eigen/Core>

#include "sim/report/motion_series.h"

namespace condyle {

/// Where the lower incisal point is in the bite: where its border movements begin, or a glide
/// closes; the place at rest of a motion that shows neither. A case may rest with its teeth apart.
Eigen::Vector3d bite_place(const MotionSeries& series);

}  // namespace condyle
