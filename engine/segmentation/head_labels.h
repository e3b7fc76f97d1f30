#pragma once

#include "engine/segmentation/bone_voxels.h"

namespace condyle {

/// Labels of the bones and teeth of a head.
constexpr VoxelLabel skull_label = 1, mandible_label = 2, upper_teeth_label = 3,
                     lower_teeth_label = 4;

}  // namespace condyle
