#pragma once

#include <string>

#include "engine/mesh/tri_mesh.h"
#include "engine/segmentation/bone_voxels.h"

namespace condyle {

struct SurfaceOptions {
  int target_triangles = 400000;  // 0: all
  double least_piece_mm3 = 100;   // smaller closed pieces are dropped
  int threads = 1;
};

/// A surface found in a scan, closed and oriented outward, mm, LPS.
struct ScanSurface {
  TriMesh mesh;
  std::size_t found_triangles = 0;  // before decimation
  double moved_fraction = 0;        // of the vertices, to a half-way level of their own
  // Distances of the vertices before decimation from the decimated surface, mm.
  double decimation_median_mm = 0, decimation_p95_mm = 0, decimation_max_mm = 0;
};

/// The surface of the bone with a label, apart from the others. It does not pass through itself
/// where that can be avoided. Where the bones of the two jaws meet and the scan shows no gap, it
/// lies half a voxel inside its bone. Without such voxels it is empty.
ScanSurface bone_surface(const Volume& volume, const BoneVoxels& bone, VoxelLabel label,
                         const SurfaceOptions& options = {}, const Progress& progress = {});

/// The skin's outer surface: mouth, nose and airways are closed; where the scan ends, a flat face
/// closes it. Streaks from `metal` are cut off. `name`: the scan in messages. throws: InputError
/// when there is no air around the head.
ScanSurface skin_surface(const Volume& volume, const TissueLevels& levels, const HeadRegion& head,
                         const std::optional<MetalSlab>& metal, const std::string& name,
                         const SurfaceOptions& options = {}, const Progress& progress = {});

}  // namespace condyle
