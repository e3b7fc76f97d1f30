#pragma once

#include <optional>

#include "engine/segmentation/bone_voxels.h"

// Streaks from metal. Only for this module.
namespace condyle {

/// The slices with metal in the bone, and 1 mm beyond; none without metal, and none where it spans
/// more than 40 mm.
std::optional<MetalSlab> find_metal(const Volume& volume, const BoneVoxels& bone);

/// Relabels as no bone what is bright in the slab, within 50 mm of the metal, and more than 4 mm
/// outside the bone that is interpolated between the slices below and above it; from 1 to 4 mm
/// outside only what is faint: the least value of bone rises with the distance. Bone that is more
/// than 10 mm from that of one end counts from the other.
void drop_streaks(const Volume& volume, const MetalSlab& slab, BoneVoxels& bone, int threads);

/// Repairs the outline of the head in the slab where it is farther than 3 mm outside or 4 mm inside
/// of that above and below: streaks narrower than 10 mm become air, dents get `soft_hu`.
/// What remains of streaks is blurred out of the outline. `level_hu`: of the outline;
/// `first_slice`: of `solid`, counted in the volume.
void trim_streaks(const MetalSlab& slab, double level_hu, std::int16_t soft_hu, int first_slice,
                  Volume& solid, int threads);

}  // namespace condyle
