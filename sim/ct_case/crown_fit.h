#pragma once

#include <optional>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"
#include "engine/segmentation/bone_voxels.h"
#include "sim/anatomy_fit/anatomy_fit.h"

namespace condyle {

/// Where the crowns of a fitted template lie in a scan.
struct CrownFit {
  Pose X;                        // from where the fit of the bone put them; LPS, mm
  double moved_mm = 0;           // mean of the crowns' vertices
  double before = 0, after = 0;  // share of these at a border of the bone, 0 to 1
};

/// Moves the template's crowns as a whole to where most of their vertices lie at a border of the
/// bone with `label`: crowns may be inclined and high otherwise than the bone below them foretells.
/// The search reaches 10 mm and 12 degrees about the transverse axis. None where that is hardly
/// better. teeth, template_bone: of the fitted template, in the volume's frame.
std::optional<CrownFit> fit_crowns(const Volume& volume, const BoneVoxels& bone, VoxelLabel label,
                                   const TriMesh& teeth, const TriMesh& template_bone);

/// Moves the fitted crowns of an arch, and the landmarks of its teeth.
void move_crowns(Role teeth, const Pose& X, AnatomyFit& fit);

}  // namespace condyle
