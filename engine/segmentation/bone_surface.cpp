#include <algorithm>
#include <array>
#include <limits>

#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/self_crossings.h"
#include "engine/mesh/unfold.h"
#include "engine/segmentation/half_way.h"
#include "engine/segmentation/head_labels.h"
#include "engine/segmentation/lattice_surface.h"
#include "engine/segmentation/volume_values.h"
#include "engine/volume/blur.h"

namespace condyle {
namespace {

constexpr int margin_voxels = 3;
constexpr std::int16_t whole_side =
    1000;  // of the blurred difference between a bone and the others
constexpr double border_blur_voxels = 0.8;

/// The voxels of a label with a margin, in coordinates of the bone's box.
VoxelBox box_of_label(const BoneVoxels& bone, VoxelLabel label) {
  std::array<int, 3> low, high = {-1, -1, -1};
  low.fill(std::numeric_limits<int>::max());
  std::size_t q = 0;
  for (int k = 0; k < bone.box.size[2]; ++k)
    for (int j = 0; j < bone.box.size[1]; ++j)
      for (int i = 0; i < bone.box.size[0]; ++i, ++q) {
        if (bone.label[q] != label) continue;
        const std::array<int, 3> at = {i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], at[a]);
          high[a] = std::max(high[a], at[a]);
        }
      }
  if (high[0] < 0) return {};
  VoxelBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = low[a];
    box.size[a] = high[a] - low[a] + 1;
  }
  return box.grown(margin_voxels).within({{0, 0, 0}, bone.box.size});
}

/// Threshold minus value; between the bone and others, the middle between their voxels.
std::vector<float> bone_values(const BoneVoxels& bone, VoxelLabel label, const VoxelBox& part,
                               int threads) {
  std::vector<std::int16_t> side(part.count());
  std::vector<float> values(part.count());
  const auto place = [&](int i, int j, int k) {
    return bone.box.index(part.low[0] + i, part.low[1] + j, part.low[2] + k);
  };
  parallel_for(static_cast<std::size_t>(part.size[2]), threads, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < part.size[1]; ++j)
      for (int i = 0; i < part.size[0]; ++i) {
        const VoxelLabel here = bone.label[place(i, j, k)];
        side[part.index(i, j, k)] = here == label     ? whole_side
                                    : here == no_bone ? std::int16_t{0}
                                                      : static_cast<std::int16_t>(-whole_side);
      }
  });
  blur(side, part.size, border_blur_voxels, threads);
  parallel_for(static_cast<std::size_t>(part.size[2]), threads, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < part.size[1]; ++j)
      for (int i = 0; i < part.size[0]; ++i) {
        const std::size_t q = part.index(i, j, k), at = place(i, j, k);
        const auto below = static_cast<float>(bone.threshold_hu - bone.smooth[at]);
        // A voxel of the bone stays inside, another one outside, whatever surrounds it.
        const auto apart = static_cast<float>(-side[q]);
        if (bone.label[at] == label)
          values[q] = std::max(below, std::min(apart, -1.0f));
        else
          values[q] = std::max(below, std::max(apart, bone.label[at] == no_bone ? below : 1.0f));
        const bool border = i == 0 || j == 0 || k == 0 || i + 1 == part.size[0] ||
                            j + 1 == part.size[1] || k + 1 == part.size[2];
        if (border) values[q] = std::max(values[q], 1.0f);
      }
  });
  return values;
}

/// Whether a gap parts two bones in life: the bone of one jaw and bone or teeth of the other.
bool live_apart(VoxelLabel bone, VoxelLabel other) {
  return (bone == skull_label && (other == mandible_label || other == lower_teeth_label)) ||
         (bone == mandible_label && (other == skull_label || other == upper_teeth_label));
}

/// Places vertices that have moved into, or beside, voxels of another bone, so that surfaces do not
/// pass through each other. Those that have moved inward from a darker gap between the bones, as
/// in a joint, stay. Others return to where they were; where the bones live apart, half a voxel
/// inside that.
void part_from_other_bones(const Volume& volume, const BoneVoxels& bone, VoxelLabel label,
                           const TriMesh& before, int threads, TriMesh& mesh) {
  constexpr double gap_hu = 150, least_gap_voxels = 1;
  const auto other_at = [&](int i, int j, int k) {
    const std::array<int, 3> at = {i - bone.box.low[0], j - bone.box.low[1], k - bone.box.low[2]};
    for (std::size_t a = 0; a < 3; ++a)
      if (at[a] < 0 || at[a] >= bone.box.size[a]) return no_bone;
    const VoxelLabel here = bone.label[bone.box.index(at[0], at[1], at[2])];
    return here == label ? no_bone : here;
  };
  const VolumeValues values(volume);
  const std::vector<Eigen::Vector3d> normals = vertex_normals(before);
  const auto beside_gap = [&](std::size_t v) {
    const Eigen::Vector3d from = before.vertices[v],
                          step = 0.5 * values.step_mm(normals[v]) * normals[v];
    double inside = values(from);
    for (int n = 1; n <= 4; ++n) inside = std::max(inside, values(from - n * step));
    return values(from) < inside - gap_hu;
  };
  parallel_for(before.vertices.size(), threads, [&](std::size_t v) {
    const Eigen::Vector3d q = (volume.axes.transpose() * (mesh.vertices[v] - volume.origin))
                                  .cwiseQuotient(volume.spacing_mm);
    const Eigen::Vector3i low = q.array().floor().cast<int>();
    bool beside = false, apart = false;
    for (int corner = 0; corner < 8; ++corner) {
      const VoxelLabel other =
          other_at(low.x() + (corner & 1), low.y() + (corner >> 1 & 1), low.z() + (corner >> 2));
      beside = beside || other != no_bone;
      apart = apart || (other != no_bone && live_apart(label, other));
    }
    if (!beside) return;
    const Eigen::Vector3d& n = normals[v];
    const bool inward = (mesh.vertices[v] - before.vertices[v]).dot(n) < 0, gap = beside_gap(v);
    if (inward && gap) return;
    mesh.vertices[v] = before.vertices[v];
    if (apart && !gap) mesh.vertices[v] -= 0.5 * least_gap_voxels * values.step_mm(n) * n;
  });
}

}  // namespace

ScanSurface bone_surface(const Volume& volume, const BoneVoxels& bone, VoxelLabel label,
                         const SurfaceOptions& options, const Progress& progress) {
  report(progress, "finding the surface", 0);
  ScanSurface surface;
  const VoxelBox part = box_of_label(bone, label);
  if (part.empty()) return surface;
  VoxelBox in_volume = part;
  for (std::size_t a = 0; a < 3; ++a) in_volume.low[a] += bone.box.low[a];
  surface.mesh = lattice_surface(volume, in_volume, bone_values(bone, label, part, options.threads),
                                 options.least_piece_mm3);
  report(progress, "finding the surface", 1);
  const TriMesh before = surface.mesh;
  surface.moved_fraction =
      move_to_half_way(surface.mesh, volume,
                       {.threshold_hu = bone.threshold_hu, .threads = options.threads}, progress);
  part_from_other_bones(volume, bone, label, before, options.threads, surface.mesh);
  const UnfoldSettings flat{.most_mm = 0.5 * volume.spacing_mm.minCoeff()};
  unfold(surface.mesh, flat);
  uncross(surface.mesh, before.vertices, options.threads);
  unfold_apart(surface.mesh, flat, options.threads);  // what went back may be folded again
  decimate_surface(surface, Flaws::crossings, options, progress);
  return surface;
}

}  // namespace condyle
