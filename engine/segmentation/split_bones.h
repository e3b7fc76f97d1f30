#pragma once

#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "engine/segmentation/bone_voxels.h"

namespace condyle {

/// A place that is known to lie in one bone, mm.
struct SeedPoint {
  Eigen::Vector3d position;
  VoxelLabel label = 1;
};

/// A bone of the template, posed in the scan: a closed surface near that of the bone.
struct SeedSurface {
  TriMesh mesh;
  VoxelLabel label = 1;
};

struct SeedOptions {
  double template_error_mm = 2;  // rms, of the surfaces
  double point_radius_mm = 1.5;  // of the ball of bone around a point that gets its label
  int threads = 1;
};

/// Labels of the voxels of which it is certain to which bone they belong; no_bone elsewhere. Points
/// decide where they contradict surfaces. A voxel is certain where it is deeper inside one surface
/// than the margin, 1.25 times the template's error, or inside one and at least two margins outside
/// all others. throws: InputError for a point, named by its number, that is not near bone.
std::vector<VoxelLabel> seed_labels(const Volume& volume, const BoneVoxels& bone,
                                    const std::vector<SeedSurface>& surfaces,
                                    const std::vector<SeedPoint>& points,
                                    const SeedOptions& options = {}, const Progress& progress = {});

/// Splits bone by a watershed from the seeds: voxels get the label of the seed that reaches them
/// through the deepest bone and past the faintest gaps: 0.1 voxels of depth count as much as 10 HU
/// of a gap. Pieces without a seed become `other_bone`. source: `condyle bench import`; depth alone
/// exchanges up to ten times as many voxels.
void split_bones(const Volume& volume, const std::vector<VoxelLabel>& seeds, BoneVoxels& bone,
                 int threads, const Progress& progress = {});

}  // namespace condyle
