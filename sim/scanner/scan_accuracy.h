#pragma once

#include <functional>

#include "engine/segmentation/head_labels.h"
#include "engine/segmentation/split_bones.h"
#include "sim/scanner/ct_scan.h"

namespace condyle {

// What was found in a scan of the built-in patient, compared with the truth.

/// Distances of a found surface's vertices from the true one, absolute, mm.
struct SurfaceErrors {
  std::size_t samples = 0;
  double median_mm = 0, p95_mm = 0, max_mm = 0;
  double bias_mm = 0;  // mean of the signed distances; positive: outside the true surface
};

/// The signed distance from the true surface, mm, of a vertex by its number and place.
using TrueDistance = std::function<double(std::size_t vertex, const Eigen::Vector3d& p)>;

/// Of at most 15000 vertices that lie at least three voxels inside the field of view.
SurfaceErrors surface_errors(const TriMesh& found, const Volume& volume,
                             const TrueDistance& true_distance, int threads);

/// Voxels above the threshold whose truth is one of the two bones, by their labels.
struct SplitErrors {
  std::size_t voxels = 0, exchanged = 0, unlabelled = 0, seeds = 0, wrong_seeds = 0;
  double wrong_percent() const { return voxels ? 100.0 * exchanged / voxels : 0; }
};
SplitErrors split_errors(const CtScan& scan, const BoneVoxels& bone,
                         const std::vector<VoxelLabel>& seeds);

/// The built-in patient's bones as a template that fits badly: moved and warped by waves of about
/// 60 mm. `rms_mm`: of all displacements.
std::vector<SeedSurface> warped_template(const Case& patient, double rms_mm, std::uint64_t seed);

}  // namespace condyle
