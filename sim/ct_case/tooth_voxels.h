#pragma once

#include "engine/mesh/tri_mesh.h"
#include "engine/segmentation/bone_voxels.h"

namespace condyle {

/// Gives voxels of a bone that lie nearer to the fitted template's teeth than to its bone the label
/// of the teeth. Depths inside count as negative distances: roots stay with the bone around them.
void label_teeth(const Volume& volume, const TriMesh& template_teeth, const TriMesh& template_bone,
                 VoxelLabel bone_label, VoxelLabel teeth_label, BoneVoxels& bone, int threads);

}  // namespace condyle
