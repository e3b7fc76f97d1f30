#pragma once

#include <vector>

#include "sim/osteotomy/recipe.h"
#include "sim/osteotomy/surgical_anatomy.h"

namespace condyle {

/// Places on the ramus of one side.
struct Ramus {
  Eigen::Vector3d lingula;
  double front, back;  // its borders at the height of the lingula: y
};

/// The lingula where the case has it; else 0.42 of the way down from the sigmoid notch to gonion
/// and 0.45 of the ramus' width from the front.
Ramus find_ramus(SurgicalAnatomy& jaw, Side side);

/// Landmarks, else the bone's shape: the lowest point between coronoid process and condyle.
Eigen::Vector3d find_notch(SurgicalAnatomy& jaw, Side side);
/// Landmark, else the point of the side that is farthest down and back.
Eigen::Vector3d find_gonion(SurgicalAnatomy& jaw, Side side);

/// Normal of the occlusal plane through the lower incisal point and the first molars; up, where
/// the case has no such points.
Eigen::Vector3d occlusal_up(const SurgicalAnatomy& jaw);

/// Segments of a cut on each side, of which the proximal part is above.
std::vector<SegmentRule> proximal_and_distal();

}  // namespace condyle
