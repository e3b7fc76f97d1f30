#include "engine/segmentation/split_bones.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/field/mesh_field.h"
#include "engine/segmentation/distance_map.h"
#include "engine/volume/lines.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double margin_per_error = 1.25;
constexpr double inside_mm = 0.5;  // this far outside still counts as inside a surface
constexpr double field_step_mm = 2;
constexpr int deepest = 512, darkest = 128;  // buckets of the queue for depth and for gaps
constexpr int bucket_count = deepest + darkest;
constexpr double step_voxels = 0.1;        // depth of one bucket, in steps of the finest axis
constexpr double gap_mm = 1, gap_hu = 10;  // width of a gap, and darkness of one bucket
constexpr double point_reach_mm = 4;       // of a point to the nearest bone

Box box_of(const Volume& volume, const VoxelBox& box) {
  Box around;
  for (int corner = 0; corner < 8; ++corner)
    around.add(box.position(volume, corner & 1 ? box.size[0] - 1 : 0,
                            corner & 2 ? box.size[1] - 1 : 0, corner & 4 ? box.size[2] - 1 : 0));
  return around;
}

/// Marks the bone that the surfaces are certain of.
void seed_from_surfaces(const Volume& volume, const BoneVoxels& bone,
                        const std::vector<SeedSurface>& surfaces, const SeedOptions& options,
                        const Progress& progress, std::vector<VoxelLabel>& seeds) {
  const double margin = margin_per_error * options.template_error_mm;
  const Box around = box_of(volume, bone.box);
  const auto grid = even_grid({around.low, around.high}, field_step_mm);
  std::vector<SampledField> fields;
  for (const SeedSurface& surface : surfaces) {
    report(progress, "placing seeds",
           0.7 * static_cast<double>(fields.size()) / static_cast<double>(surfaces.size()));
    fields.push_back(mesh_field(surface.mesh, grid, 2 * margin + field_step_mm, options.threads));
  }
  report(progress, "placing seeds", 0.7);
  parallel_for(static_cast<std::size_t>(bone.box.size[2]), options.threads, [&](std::size_t k) {
    std::vector<double> d(fields.size());
    for (int j = 0; j < bone.box.size[1]; ++j)
      for (int i = 0; i < bone.box.size[0]; ++i) {
        const std::size_t q = bone.box.index(i, j, static_cast<int>(k));
        if (bone.label[q] == no_bone || bone.label[q] == other_bone) continue;
        const Vector3d p = bone.box.position(volume, i, j, static_cast<double>(k));
        std::size_t best = 0;
        for (std::size_t f = 0; f < fields.size(); ++f) {
          d[f] = even_value(fields[f], p);
          if (d[f] < d[best]) best = f;
        }
        double others = std::numeric_limits<double>::infinity();
        for (std::size_t f = 0; f < fields.size(); ++f)
          if (surfaces[f].label != surfaces[best].label) others = std::min(others, d[f]);
        if (d[best] < -margin || (d[best] < inside_mm && others > 2 * margin))
          seeds[q] = surfaces[best].label;
      }
  });
}

/// Marks the bone around a point. Returns whether there is any.
bool seed_ball(const Volume& volume, const BoneVoxels& bone, const Vector3d& center, double radius,
               VoxelLabel label, std::vector<VoxelLabel>& seeds) {
  const Vector3d at =
      (volume.axes.transpose() * (center - volume.origin)).cwiseQuotient(volume.spacing_mm);
  std::array<int, 3> low, high;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const double reach = radius / volume.spacing_mm[a] + 1, local = at[a] - bone.box.low[axis];
    low[axis] =
        static_cast<int>(std::clamp(std::floor(local - reach), 0.0, 1.0 * bone.box.size[axis]));
    high[axis] =
        static_cast<int>(std::clamp(std::ceil(local + reach), -1.0, bone.box.size[axis] - 1.0));
  }
  bool found = false;
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int i = low[0]; i <= high[0]; ++i) {
        const std::size_t q = bone.box.index(i, j, k);
        if (bone.label[q] == no_bone || bone.label[q] == other_bone) continue;
        if ((bone.box.position(volume, i, j, k) - center).norm() > radius) continue;
        seeds[q] = label;
        found = true;
      }
  return found;
}

/// Priority queue of voxels by bucket; voxels of one bucket in order of arrival.
class FloodQueue {
 public:
  struct Entry {
    std::uint32_t voxel;
    VoxelLabel label;
  };
  FloodQueue() : buckets_(bucket_count) {}
  void push(int bucket, const Entry& entry) {
    buckets_[static_cast<std::size_t>(std::clamp(bucket, current_, bucket_count - 1))].push_back(
        entry);
  }
  template <class Take>
  void run(const Take& take, const Progress& progress) {
    for (current_ = 0; current_ < bucket_count; ++current_) {
      if (current_ % 16 == 0)
        report(progress, "splitting bones", 0.3 + 0.7 * current_ / bucket_count);
      auto& bucket = buckets_[static_cast<std::size_t>(current_)];
      for (std::size_t e = 0; e < bucket.size(); ++e) {
        const Entry entry = bucket[e];
        take(entry);
      }
      std::vector<Entry>().swap(bucket);
    }
  }

 private:
  std::vector<std::vector<Entry>> buckets_;
  int current_ = 0;
};

/// Replaces each value by the largest (or smallest) within `reach` steps along each axis.
template <class Better>
void keep_extremes(std::vector<std::int16_t>& values, const std::array<int, 3>& size,
                   const std::array<int, 3>& reach, int threads, const Better& better) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    change_lines(
        values, size, static_cast<int>(axis), threads,
        [&](float* line, std::size_t n) {
          thread_local std::vector<float> before;
          before.assign(line, line + n);
          const auto r = static_cast<std::size_t>(reach[axis]);
          for (std::size_t q = 0; q < n; ++q)
            for (std::size_t other = q > r ? q - r : 0; other <= std::min(q + r, n - 1); ++other)
              line[q] = better(line[q], before[other]);
        },
        [](float value) { return static_cast<std::int16_t>(value); });
}

/// How much darker each voxel is than what surrounds it on both sides: the closing by a cube of
/// 1 mm minus the value. Gaps between bones are dark.
std::vector<std::int16_t> gap_darkness(const Volume& volume, const BoneVoxels& bone, int threads) {
  std::array<int, 3> reach;
  for (std::size_t a = 0; a < 3; ++a)
    reach[a] =
        std::max(1, static_cast<int>(std::lround(gap_mm / volume.spacing_mm[static_cast<int>(a)])));
  std::vector<std::int16_t> closed = bone.smooth;
  keep_extremes(closed, bone.box.size, reach, threads,
                [](float a, float b) { return std::max(a, b); });
  keep_extremes(closed, bone.box.size, reach, threads,
                [](float a, float b) { return std::min(a, b); });
  for (std::size_t q = 0; q < closed.size(); ++q)
    closed[q] = static_cast<std::int16_t>(closed[q] - bone.smooth[q]);
  return closed;
}

/// Bucket of each voxel of bone: 0 is the deepest; gaps come later.
std::vector<std::uint16_t> flood_buckets(const Volume& volume, const BoneVoxels& bone,
                                         int threads) {
  std::vector<float> depth(bone.box.count());
  for (std::size_t q = 0; q < depth.size(); ++q)
    depth[q] = bone.label[q] == no_bone || bone.label[q] == other_bone ? 0 : no_feature;
  make_squared_distances(depth, bone.box.size, volume.spacing_mm, threads);
  const double step_mm = step_voxels * volume.spacing_mm.minCoeff();
  const std::vector<std::int16_t> gap = gap_darkness(volume, bone, threads);
  std::vector<std::uint16_t> buckets(depth.size());
  for (std::size_t q = 0; q < depth.size(); ++q) {
    const double shallow = deepest - 1 - std::min(deepest - 1.0, std::sqrt(depth[q]) / step_mm);
    const double dark = std::min<double>(darkest, gap[q] / gap_hu);
    buckets[q] = static_cast<std::uint16_t>(shallow + dark);
  }
  return buckets;
}

}  // namespace

std::vector<VoxelLabel> seed_labels(const Volume& volume, const BoneVoxels& bone,
                                    const std::vector<SeedSurface>& surfaces,
                                    const std::vector<SeedPoint>& points,
                                    const SeedOptions& options, const Progress& progress) {
  std::vector<VoxelLabel> seeds(bone.box.count(), no_bone);
  if (!surfaces.empty()) seed_from_surfaces(volume, bone, surfaces, options, progress, seeds);
  for (std::size_t n = 0; n < points.size(); ++n) {
    const SeedPoint& point = points[n];
    bool found = false;
    for (double radius = options.point_radius_mm; !found && radius <= point_reach_mm;
         radius += options.point_radius_mm)
      found = seed_ball(volume, bone, point.position, radius, point.label, seeds);
    if (!found)
      throw InputError(
          fmt::format("seed point {} at ({:.1f}, {:.1f}, {:.1f}) mm: no bone above "
                      "{:.0f} HU within {:g} mm",
                      n + 1, point.position.x(), point.position.y(), point.position.z(),
                      bone.threshold_hu, point_reach_mm));
  }
  report(progress, "placing seeds", 1);
  return seeds;
}

void split_bones(const Volume& volume, const std::vector<VoxelLabel>& seeds, BoneVoxels& bone,
                 int threads, const Progress& progress) {
  assert(seeds.size() == bone.box.count());
  assert(seeds.size() < std::numeric_limits<std::uint32_t>::max());
  report(progress, "splitting bones", 0);
  const std::vector<std::uint16_t> bucket = flood_buckets(volume, bone, threads);
  report(progress, "splitting bones", 0.3);
  const auto row = static_cast<std::int64_t>(bone.box.size[0]);
  const std::int64_t slice = row * bone.box.size[1];
  const std::array<std::int64_t, 6> steps = {1, -1, row, -row, slice, -slice};

  constexpr VoxelLabel waiting = 255;  // bone without a label yet
  for (auto& label : bone.label)
    if (label != no_bone && label != other_bone) label = waiting;
  FloodQueue queue;
  const auto spread = [&](std::uint32_t voxel, VoxelLabel label) {
    for (const std::int64_t step : steps) {
      const auto next = static_cast<std::size_t>(voxel + step);
      if (bone.label[next] == waiting)
        queue.push(bucket[next], {static_cast<std::uint32_t>(next), label});
    }
  };
  for (std::size_t q = 0; q < seeds.size(); ++q)
    if (seeds[q] != no_bone && bone.label[q] == waiting) bone.label[q] = seeds[q];
  for (std::size_t q = 0; q < seeds.size(); ++q)
    if (seeds[q] != no_bone && bone.label[q] == seeds[q])
      spread(static_cast<std::uint32_t>(q), seeds[q]);
  queue.run(
      [&](const FloodQueue::Entry& entry) {
        if (bone.label[entry.voxel] != waiting) return;
        bone.label[entry.voxel] = entry.label;
        spread(entry.voxel, entry.label);
      },
      progress);
  for (auto& label : bone.label)
    if (label == waiting) label = other_bone;
  report(progress, "splitting bones", 1);
}

}  // namespace condyle
