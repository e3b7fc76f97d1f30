#pragma once

#include <Eigen/Core>

#include "sim/report/motion_series.h"

namespace condyle {

/// Position of the lower incisal point in the bite, cranium, mm: the start of its border movements,
/// or the end of a closing glide; the rest position of a motion that has neither. A case may rest
/// with its teeth apart.
Eigen::Vector3d bite_position(const MotionSeries& series);

}  // namespace condyle
