#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/frame/part.h"

namespace condyle {

/// Factors of the colour of a part's vertices: crowns are translucent and bluish at their edges and
/// yellower towards the gum, canines yellower than incisors. Empty for a part without separate
/// crowns.
/// source: Joiner, Tooth colour: a review of the literature, 2004
std::vector<Eigen::Vector3f> tooth_tint(const Part& part);

}  // namespace condyle
