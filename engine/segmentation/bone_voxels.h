#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/segmentation/head_region.h"
#include "engine/segmentation/voxel_box.h"

namespace condyle {

/// Labels of voxels: bones are numbered from 1.
using VoxelLabel = std::uint8_t;
constexpr VoxelLabel no_bone = 0;
constexpr VoxelLabel other_bone = 254;  // bright, but of none of the bones: specks, table

/// Neighbouring slices of a scan in which metal, such as fillings, throws streaks.
struct MetalSlab {
  int axis = 2;                         // of the lattice, that of the slices
  int first = 0, last = 0;              // slices of the volume
  std::vector<Eigen::Vector3d> places;  // of metal, mm
};

/// The bone of a scan, in a box around it. The outermost voxels of the box are no bone; they may
/// lie beyond the volume.
struct BoneVoxels {
  VoxelBox box;
  std::vector<std::int16_t> smooth;  // HU after a blur of 0.6 voxels
  std::vector<VoxelLabel> label;     // 1 for all bone before it is split
  double threshold_hu = 0;           // of `smooth`
  std::optional<MetalSlab> metal;    // slices with streaks
};

struct BoneOptions {
  double threshold_hu = 0;      // 0: TissueLevels::low_bone
  double least_piece_mm3 = 30;  // smaller pieces are noise
  int threads = 1;
};

/// Bone of the head: thin bone keeps its walls, specks, streaks, table and head rest are left out,
/// marrow is filled. `name`: the scan in messages. throws: InputError when there is none.
BoneVoxels find_bone(const Volume& volume, const TissueLevels& levels, const HeadRegion& head,
                     const std::string& name, const BoneOptions& options = {},
                     const Progress& progress = {});

}  // namespace condyle
