#include "engine/segmentation/metal_streaks.h"

#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"
#include "engine/segmentation/distance_map.h"
#include "engine/segmentation/metal_slices.h"
#include "engine/volume/blur.h"

namespace condyle {
namespace {

constexpr double longest_slab_mm = 40, beyond_mm = 1;
constexpr double beside_bone_mm = 4, beside_head_mm = 3, spike_mm = 5, within_head_mm = 4;
constexpr float streak_reach_mm = 50, farthest_beside_mm = 10;
constexpr double faint_from_mm = 1, rise_hu_per_mm = 200;  // of the least bone beside bone
constexpr double fading_mm = 10, outline_blur_mm = 2;
constexpr std::int16_t streak_air_hu = -1000;

/// Squared distances from the pixels that hold, mm^2.
template <class Holds>
std::vector<float> flat_distances(const SliceLattice& lattice, const Holds& holds) {
  std::vector<float> map(lattice.pixels());
  for (std::size_t p = 0; p < map.size(); ++p) map[p] = holds(p) ? 0 : no_feature;
  make_squared_distances(map, lattice.size, lattice.spacing_mm, 1);
  return map;
}

double square(double x) { return x * x; }

/// Steps along the axes of a lattice from its first voxel to a place.
Eigen::Vector3d lattice_steps(const Volume& volume, const Eigen::Vector3d& origin,
                              const Eigen::Vector3d& p) {
  return (volume.axes.transpose() * (p - origin)).cwiseQuotient(volume.spacing_mm);
}

/// Squared distances in a slice from the metal of all slices, mm^2. `origin`: the first voxel.
std::vector<float> metal_distances(const SliceLattice& lattice, const MetalSlab& slab,
                                   const Volume& volume, const Eigen::Vector3d& origin) {
  std::vector<std::uint8_t> metal(lattice.pixels(), 0);
  for (const Eigen::Vector3d& place : slab.places) {
    const Eigen::Vector3d at = lattice_steps(volume, origin, place);
    std::array<int, 2> pixel;
    for (std::size_t a = 0; a < 2; ++a)
      pixel[a] = std::clamp(static_cast<int>(std::lround(at[static_cast<int>(lattice.axes[a])])), 0,
                            lattice.size[a] - 1);
    metal[static_cast<std::size_t>(pixel[1]) * static_cast<std::size_t>(lattice.size[0]) +
          static_cast<std::size_t>(pixel[0])] = 1;
  }
  return flat_distances(lattice, [&](std::size_t p) { return metal[p] != 0; });
}

/// Blurs the slices from `first` up to `last`, between air and soft tissue, near the metal.
void blur_outline(const SliceLattice& lattice, int first, int last,
                  const std::vector<float>& from_metal, std::int16_t soft_hu, Volume& solid,
                  int threads) {
  std::array<double, 3> sigma;
  for (std::size_t a = 0; a < 3; ++a)
    sigma[a] = outline_blur_mm / solid.spacing_mm[static_cast<int>(a)];
  const int beside = static_cast<int>(std::ceil(3 * sigma[lattice.axis]));
  const int low = std::max(0, first - beside),
            high = std::min(solid.size[lattice.axis], last + beside);
  std::array<int, 3> size = solid.size;
  size[lattice.axis] = high - low;
  std::vector<std::int16_t> smooth;
  const auto in_slab = [&](std::array<int, 3> at) {
    at[lattice.axis] -= low;
    return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(at[1])) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(at[0]);
  };
  smooth.resize(lattice.pixels() * static_cast<std::size_t>(high - low));
  for (int slice = low; slice < high; ++slice)
    for (std::size_t p = 0; p < lattice.pixels(); ++p) {
      const auto at = lattice.place(p, slice);
      smooth[in_slab(at)] =
          std::clamp(solid.values[solid.index(at[0], at[1], at[2])], streak_air_hu, soft_hu);
    }
  blur(smooth, size, sigma, threads);
  for (int slice = first; slice < last; ++slice)
    for (std::size_t p = 0; p < lattice.pixels(); ++p) {
      const double near =
          std::clamp((streak_reach_mm - std::sqrt(from_metal[p])) / fading_mm, 0.0, 1.0);
      if (near == 0) continue;
      const auto at = lattice.place(p, slice);
      std::int16_t& value = solid.values[solid.index(at[0], at[1], at[2])];
      value =
          static_cast<std::int16_t>(std::lround((1 - near) * value + near * smooth[in_slab(at)]));
    }
}

bool is_bone(VoxelLabel label) { return label != no_bone && label != other_bone; }

}  // namespace

std::optional<MetalSlab> find_metal(const Volume& volume, const BoneVoxels& bone) {
  const int level = metal_level(volume);
  const int upward = slice_axis(volume);
  const SliceLattice lattice(upward, bone.box.size, volume.spacing_mm);
  const double pixel_mm2 = lattice.spacing_mm.prod();
  MetalSlab slab{upward, -1, -1, {}};
  for (int slice = 0; slice < bone.box.size[lattice.axis]; ++slice) {
    std::vector<Eigen::Vector3d> places;
    for (std::size_t p = 0; p < lattice.pixels(); ++p) {
      const auto at = lattice.place(p, slice);
      const std::size_t q = bone.box.index(at[0], at[1], at[2]);
      if (is_bone(bone.label[q]) && volume.at(bone.box.low[0] + at[0], bone.box.low[1] + at[1],
                                              bone.box.low[2] + at[2]) >= level)
        places.push_back(bone.box.position(volume, at[0], at[1], at[2]));
    }
    if (static_cast<double>(places.size()) * pixel_mm2 < least_metal_mm2) continue;
    if (slab.first < 0) slab.first = slice;
    slab.last = slice;
    slab.places.insert(slab.places.end(), places.begin(), places.end());
  }
  const double step_mm = volume.spacing_mm[upward];
  if (slab.first < 0 || (slab.last - slab.first) * step_mm > longest_slab_mm) return std::nullopt;
  const int beyond = static_cast<int>(std::ceil(beyond_mm / step_mm));
  slab.first += bone.box.low[lattice.axis] - beyond;
  slab.last += bone.box.low[lattice.axis] + beyond;
  return slab;
}

void drop_streaks(const Volume& volume, const MetalSlab& slab, BoneVoxels& bone, int threads) {
  const SliceLattice lattice(slab.axis, bone.box.size, volume.spacing_mm);
  const int before = slab.first - bone.box.low[lattice.axis] - 1,
            after = slab.last - bone.box.low[lattice.axis] + 1,
            slices = bone.box.size[lattice.axis];
  const auto label = [&](std::size_t pixel, int slice) -> VoxelLabel& {
    const auto at = lattice.place(pixel, slice);
    return bone.label[bone.box.index(at[0], at[1], at[2])];
  };
  // Distances from the bone of the slices beside the slab, negative inside.
  const auto from_bone = [&](int slice) {
    std::vector<float> distance =
        flat_distances(lattice, [&](std::size_t p) { return is_bone(label(p, slice)); });
    const std::vector<float> depth =
        flat_distances(lattice, [&](std::size_t p) { return !is_bone(label(p, slice)); });
    for (std::size_t p = 0; p < distance.size(); ++p)
      distance[p] = std::clamp(std::sqrt(distance[p]) - std::sqrt(depth[p]), -farthest_beside_mm,
                               farthest_beside_mm);
    return distance;
  };
  // At the ends of the scan the box reaches beyond it: its outermost slices hold no bone.
  const bool has_below = before >= 1, has_above = after <= slices - 2;
  if (!has_below && !has_above) return;
  const std::vector<float> below = from_bone(has_below ? before : after),
                           above = from_bone(has_above ? after : before);
  const Eigen::Vector3d origin = bone.box.position(volume, 0, 0, 0);
  const std::vector<float> from_metal = metal_distances(lattice, slab, volume, origin);
  const int first = std::max(before + 1, 0), last = std::min(after, slices);
  parallel_for(static_cast<std::size_t>(std::max(0, last - first)), threads, [&](std::size_t s) {
    const int slice = first + static_cast<int>(s);
    const double share = static_cast<double>(slice - before) / (after - before);
    for (std::size_t p = 0; p < lattice.pixels(); ++p) {
      VoxelLabel& here = label(p, slice);
      if (!is_bone(here) || from_metal[p] >= square(streak_reach_mm)) continue;
      // Bone that ends inside the slab, such as a crown with the jaws apart, is near one end alone.
      const bool ends = std::max(below[p], above[p]) >= farthest_beside_mm;
      const double away_mm =
          ends ? std::min(below[p], above[p]) : (1 - share) * below[p] + share * above[p];
      const auto at = lattice.place(p, slice);
      const double least_hu =
          bone.threshold_hu + rise_hu_per_mm * std::max(0.0, away_mm - faint_from_mm);
      if (away_mm > beside_bone_mm || bone.smooth[bone.box.index(at[0], at[1], at[2])] < least_hu)
        here = other_bone;
    }
  });
}

void trim_streaks(const MetalSlab& slab, double level_hu, std::int16_t soft_hu, int first_slice,
                  Volume& solid, int threads) {
  const SliceLattice lattice(slab.axis, solid.size, solid.spacing_mm);
  const std::vector<float> from_metal = metal_distances(lattice, slab, solid, solid.origin);
  const int before = slab.first - first_slice - 1, after = slab.last - first_slice + 1;
  const int slices = solid.size[lattice.axis];
  const auto value = [&](std::size_t pixel, int slice) -> std::int16_t& {
    const auto at = lattice.place(pixel, slice);
    return solid.values[solid.index(at[0], at[1], at[2])];
  };
  const auto above_level = [&](std::size_t p, int slice) {
    return slice >= 0 && slice < slices && value(p, slice) > level_hu;
  };
  const std::vector<float> outside = flat_distances(
      lattice, [&](std::size_t p) { return above_level(p, before) || above_level(p, after); });
  const std::vector<float> inside = flat_distances(
      lattice, [&](std::size_t p) { return !above_level(p, before) || !above_level(p, after); });
  const int first = std::max(before + 1, 0), last = std::min(after, slices);
  parallel_for(static_cast<std::size_t>(std::max(0, last - first)), threads, [&](std::size_t s) {
    const int slice = first + static_cast<int>(s);
    const std::vector<float> depth =
        flat_distances(lattice, [&](std::size_t p) { return value(p, slice) <= level_hu; });
    const std::vector<float> from_core =
        flat_distances(lattice, [&](std::size_t p) { return depth[p] > square(spike_mm); });
    for (std::size_t p = 0; p < outside.size(); ++p) {
      if (from_metal[p] > square(streak_reach_mm)) continue;
      // The core grown by its depth and a little more is the head without what is narrow.
      if (outside[p] > square(beside_head_mm) && from_core[p] > square(spike_mm + 1))
        value(p, slice) = streak_air_hu;
      else if (inside[p] > square(within_head_mm))
        value(p, slice) = std::max(value(p, slice), soft_hu);
    }
  });
  if (first < last) blur_outline(lattice, first, last, from_metal, soft_hu, solid, threads);
}

}  // namespace condyle
