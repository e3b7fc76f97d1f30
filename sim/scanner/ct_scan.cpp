#include "sim/scanner/ct_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/core/parallel.h"
#include "engine/volume/blur.h"
#include "sim/scanner/block_scan.h"
#include "sim/scanner/disturbances.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double block_mm = 14;  // edge of a block of voxels

/// A lattice that covers the field of view.
Volume empty_volume(const CtSettings& settings) {
  Volume volume;
  volume.spacing_mm = settings.spacing_mm;
  volume.axes = settings.axes;
  const Vector3d extent = settings.field_of_view.size();
  Vector3d middle;  // of the lattice, in steps
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    volume.size[axis] =
        std::max(2, static_cast<int>(std::floor(extent[a] / settings.spacing_mm[a])) + 1);
    middle[a] = 0.5 * (volume.size[axis] - 1);
  }
  volume.origin =
      settings.field_of_view.center() - volume.axes * volume.spacing_mm.cwiseProduct(middle);
  volume.values.assign(static_cast<std::size_t>(volume.size[0]) *
                           static_cast<std::size_t>(volume.size[1]) *
                           static_cast<std::size_t>(volume.size[2]),
                       least_stored_hu);
  return volume;
}

/// The blocks of a lattice.
struct Blocks {
  std::array<int, 3> edge, count;  // voxels in a block, blocks along each axis

  explicit Blocks(const Volume& volume) {
    for (std::size_t a = 0; a < 3; ++a) {
      edge[a] = std::clamp(
          static_cast<int>(block_mm / volume.spacing_mm[static_cast<Eigen::Index>(a)]), 2, 32);
      count[a] = (volume.size[a] + edge[a] - 1) / edge[a];
    }
  }
};

/// Scans the block at a place among the blocks.
void scan_one(const ScannedHead& head, const CtSettings& settings, const Blocks& blocks,
              const std::array<int, 3>& place, CtScan& scan) {
  Volume& volume = scan.volume;
  std::array<int, 3> low, size;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = place[a] * blocks.edge[a];
    size[a] = std::min(blocks.edge[a], volume.size[a] - low[a]);
  }
  std::vector<Vector3d> points;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i)
        points.push_back(volume.position(low[0] + i, low[1] + j, low[2] + k));
  const BlockScan found =
      scan_block(head, settings, points, size, std::cbrt(volume.spacing_mm.prod()));
  std::size_t at = 0;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i, ++at) {
        const std::size_t q = volume.index(low[0] + i, low[1] + j, low[2] + k);
        volume.values[q] = stored_hu(found.hu[at]);
        scan.truth[q] = found.tissue[at];
      }
}

}  // namespace

CtScan scan_ct(const ScannedHead& head, const CtSettings& settings, const Progress& progress) {
  CtScan scan{empty_volume(settings), {}};
  Volume& volume = scan.volume;
  scan.truth.assign(volume.values.size(), ScanTissue::outside);
  const Blocks blocks(volume);
  const int across = blocks.count[0], along = blocks.count[1], up = blocks.count[2];
  for (int k = 0; k < up; ++k) {
    report(progress, "scanning the head", static_cast<double>(k) / up);
    parallel_for(static_cast<std::size_t>(across * along), settings.threads, [&](std::size_t n) {
      const int place = static_cast<int>(n);
      scan_one(head, settings, blocks, {place % across, place / across, k}, scan);
    });
  }
  if (settings.table) draw_table(head, settings.threads, volume);
  if (settings.fillings) draw_fillings(head, settings.seed, settings.threads, volume);
  report(progress, "point spread and noise", 1);
  blur(volume.values, volume.size, settings.point_spread, settings.threads);
  add_noise(settings.noise_hu, settings.seed, settings.threads, volume);
  return scan;
}

}  // namespace condyle
