#include "engine/segmentation/bone_voxels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/segmentation/marrow.h"
#include "engine/segmentation/metal_streaks.h"
#include "engine/segmentation/voxel_pieces.h"
#include "engine/volume/blur.h"

namespace condyle {
namespace {

constexpr double blur_voxels = 0.6;
constexpr std::int16_t beyond_hu = -1024;

/// Voxels around the cells of the head that are brighter on average than soft tissue.
VoxelBox bright_box(const Volume& volume, const HeadRegion& head, double above_hu) {
  return box_of_cells(
      volume, head,
      [&](std::size_t cell) { return head.mean[cell] >= above_hu && head.head[cell] == 1; }, 2, 2);
}

/// The values in a box, blurred; air beyond the volume.
std::vector<std::int16_t> blurred_box(const Volume& volume, const VoxelBox& box, int threads) {
  const VoxelBox inside = box.within(whole_box(volume));
  std::vector<std::int16_t> values(inside.count());
  for (int k = 0; k < inside.size[2]; ++k)
    for (int j = 0; j < inside.size[1]; ++j)
      std::copy_n(
          volume.values.data() + volume.index(inside.low[0], inside.low[1] + j, inside.low[2] + k),
          inside.size[0], values.data() + inside.index(0, j, k));
  blur(values, inside.size, blur_voxels, threads);
  if (inside.size == box.size) return values;
  std::vector<std::int16_t> padded(box.count(), beyond_hu);
  for (int k = 0; k < inside.size[2]; ++k)
    for (int j = 0; j < inside.size[1]; ++j)
      std::copy_n(
          values.data() + inside.index(0, j, k), inside.size[0],
          padded.data() + box.index(inside.low[0] - box.low[0], inside.low[1] + j - box.low[1],
                                    inside.low[2] + k - box.low[2]));
  return padded;
}

void mark_bright(const HeadRegion& head, BoneVoxels& bone, int threads) {
  const auto [nx, ny, nz] = bone.box.size;
  bone.label.assign(bone.box.count(), no_bone);
  parallel_for(static_cast<std::size_t>(nz), threads, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    if (k == 0 || k + 1 == bone.box.size[2]) return;
    for (int j = 1; j + 1 < bone.box.size[1]; ++j)
      for (int i = 1; i + 1 < bone.box.size[0]; ++i) {
        const std::size_t q = bone.box.index(i, j, k);
        if (bone.smooth[q] <= bone.threshold_hu) continue;
        bone.label[q] = head.holds(bone.box.low[0] + i, bone.box.low[1] + j, bone.box.low[2] + k)
                            ? 1
                            : other_bone;
      }
  });
}

/// Gives small pieces of bone the label of what is no bone. Returns the number of voxels kept.
std::size_t drop_specks(BoneVoxels& bone, double least_voxels) {
  const VoxelPieces pieces = find_pieces(bone.label, bone.box.size, 1, Connectivity::corners);
  std::size_t kept = 0;
  for_runs(pieces, bone.box.size[0], [&](std::size_t q, const VoxelRun& run) {
    const int length = run.last - run.first + 1;
    if (static_cast<double>(pieces.voxels[static_cast<std::size_t>(run.piece)]) >= least_voxels)
      kept += static_cast<std::size_t>(length);
    else
      std::fill_n(bone.label.begin() + static_cast<std::ptrdiff_t>(q), length, other_bone);
  });
  return kept;
}

}  // namespace

BoneVoxels find_bone(const Volume& volume, const TissueLevels& levels, const HeadRegion& head,
                     const std::string& name, const BoneOptions& options,
                     const Progress& progress) {
  report(progress, "finding bone", 0);
  BoneVoxels bone;
  bone.threshold_hu = options.threshold_hu > 0 ? options.threshold_hu : levels.low_bone();
  bone.box = bright_box(volume, head, 0.5 * (levels.soft + bone.threshold_hu));
  const auto none = [&] {
    return InputError(
        fmt::format("{}: no bone above {:.0f} HU in the head", name, bone.threshold_hu));
  };
  if (bone.box.empty()) throw none();
  bone.smooth = blurred_box(volume, bone.box, options.threads);
  report(progress, "finding bone", 0.4);
  mark_bright(head, bone, options.threads);
  report(progress, "finding bone", 0.6);
  bone.metal = find_metal(volume, bone);
  if (bone.metal) drop_streaks(volume, *bone.metal, bone, options.threads);
  const double voxel_mm3 = volume.spacing_mm.prod();
  if (drop_specks(bone, options.least_piece_mm3 / voxel_mm3) == 0) throw none();
  report(progress, "finding bone", 0.8);
  fill_marrow(volume, options.threads, bone);
  report(progress, "finding bone", 1);
  return bone;
}

}  // namespace condyle
