#pragma once

#include "engine/segmentation/bone_voxels.h"

namespace condyle {

/// Makes marrow bone, because its walls are no surface of the bone: cavities that bone encloses, or
/// bone and the end of the scan, and those that only pinholes in thin bone join with the outside.
void fill_marrow(const Volume& volume, int threads, BoneVoxels& bone);

}  // namespace condyle
