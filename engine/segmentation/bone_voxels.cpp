#include "engine/segmentation/bone_voxels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/segmentation/metal_streaks.h"
#include "engine/segmentation/voxel_pieces.h"
#include "engine/volume/blur.h"

namespace condyle {
namespace {

constexpr double blur_voxels = 0.6;
constexpr double air_in_cavity_hu = -200;  // a cavity with a lower mean holds air, not marrow
constexpr double largest_marrow_mm3 = 50000;
constexpr double largest_cut_marrow_mm3 = 5000;  // of marrow that the end of the scan cuts open
constexpr double smallest_cavity_mm3 = 60;       // smaller ones are noise, or metal out of range
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

/// Calls change(first voxel, run) for each run.
template <class Change>
void for_runs(const VoxelPieces& pieces, int row_size, const Change& change) {
  for (std::size_t row = 0; row + 1 < pieces.row_start.size(); ++row)
    for (std::size_t r = pieces.row_start[row]; r < pieces.row_start[row + 1]; ++r)
      change(
          row * static_cast<std::size_t>(row_size) + static_cast<std::size_t>(pieces.runs[r].first),
          pieces.runs[r]);
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

/// Fills marrow that bone encloses, or bone and the end of the scan: its walls are no surface of
/// the bone.
void fill_marrow(const VoxelBox& inside, double voxel_mm3, BoneVoxels& bone) {
  // A cavity at the end of the scan ends there: it is not joined with the outside.
  std::vector<VoxelLabel> within(inside.count());
  const auto place = [&](int i, int j, int k) {
    return bone.box.index(inside.low[0] - bone.box.low[0] + i, inside.low[1] - bone.box.low[1] + j,
                          inside.low[2] - bone.box.low[2] + k);
  };
  for (int k = 0; k < inside.size[2]; ++k)
    for (int j = 0; j < inside.size[1]; ++j)
      std::copy_n(bone.label.data() + place(0, j, k), inside.size[0],
                  within.data() + inside.index(0, j, k));
  const VoxelPieces pieces = find_pieces(within, inside.size, no_bone, Connectivity::faces);
  const auto for_voxels = [&](const auto& visit) {
    for_runs(pieces, inside.size[0], [&](std::size_t q, const VoxelRun& run) {
      const auto row = static_cast<int>(q / static_cast<std::size_t>(inside.size[0]));
      const std::size_t at = place(run.first, row % inside.size[1], row / inside.size[1]);
      for (int i = 0; i <= run.last - run.first; ++i)
        visit(static_cast<std::size_t>(run.piece), at + static_cast<std::size_t>(i));
    });
  };
  std::vector<double> sum(pieces.voxels.size(), 0);
  for_voxels([&](std::size_t piece, std::size_t at) { sum[piece] += bone.smooth[at]; });
  std::vector<std::uint8_t> filled(pieces.voxels.size(), 0);
  for (std::size_t piece = 0; piece < filled.size(); ++piece) {
    const auto voxels = static_cast<double>(pieces.voxels[piece]);
    const double mm3 = voxels * voxel_mm3;
    const bool holds_air = sum[piece] < air_in_cavity_hu * voxels;
    filled[piece] =
        mm3 <= (pieces.at_border[piece] ? largest_cut_marrow_mm3 : largest_marrow_mm3) &&
        (!holds_air || (mm3 <= smallest_cavity_mm3 && !pieces.at_border[piece]));
  }
  const auto bright = static_cast<std::int16_t>(std::ceil(bone.threshold_hu) + 1);
  for_voxels([&](std::size_t piece, std::size_t at) {
    if (!filled[piece]) return;
    bone.label[at] = 1;
    bone.smooth[at] = std::max(bone.smooth[at], bright);
  });
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
  fill_marrow(bone.box.within(whole_box(volume)), voxel_mm3, bone);
  report(progress, "finding bone", 1);
  return bone;
}

}  // namespace condyle
