#include "engine/segmentation/head_region.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/segmentation/distance_map.h"
#include "engine/segmentation/voxel_pieces.h"

namespace condyle {
namespace {

using Mask = std::vector<std::uint8_t>;
using Size = std::array<int, 3>;

constexpr double cell_mm = 2;
constexpr double core_depth_mm = 4;     // tissue deeper than this is the core of the head
constexpr double close_mm = 5;          // from the core: what belongs to the head for certain
constexpr double longest_part_mm = 32;  // from the core: ears and nose, but no table
// Tissue fills about two thirds of the cells of an ear, a sheet of a head rest none.
constexpr int full_cell_hu = -150;
constexpr double least_full_fraction = 0.3;
constexpr double opening_mm = 6;  // openings narrower than twice this are bridged
constexpr double least_head_cm3 = 100;

void average_cells(const Volume& volume, HeadRegion& region, int threads) {
  for (std::size_t a = 0; a < 3; ++a) {
    region.cell[a] = std::max(
        1, static_cast<int>(std::lround(cell_mm / volume.spacing_mm[static_cast<int>(a)])));
    region.size[a] = (volume.size[a] + region.cell[a] - 1) / region.cell[a];
  }
  const auto [nx, ny, nz] = region.size;
  region.mean.resize(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
                     static_cast<std::size_t>(nz));
  parallel_for(static_cast<std::size_t>(nz), threads, [&](std::size_t slice) {
    const auto row = static_cast<std::size_t>(region.size[0]);
    const auto rows = static_cast<std::size_t>(region.size[1]);
    std::vector<std::int64_t> sum(row * rows, 0);
    std::vector<int> count(row * rows, 0);
    const int first = static_cast<int>(slice) * region.cell[2];
    for (int k = first; k < std::min(first + region.cell[2], volume.size[2]); ++k)
      for (int j = 0; j < volume.size[1]; ++j) {
        const std::size_t start = static_cast<std::size_t>(j / region.cell[1]) * row;
        const std::int16_t* at = volume.values.data() + volume.index(0, j, k);
        for (int i = 0; i < volume.size[0]; ++i) {
          const std::size_t c = start + static_cast<std::size_t>(i / region.cell[0]);
          sum[c] += at[i];
          ++count[c];
        }
      }
    for (std::size_t c = 0; c < sum.size(); ++c)
      region.mean[slice * row * rows + c] = static_cast<std::int16_t>(sum[c] / count[c]);
  });
}

/// Distance of each cell from those that hold, mm.
template <class Holds>
std::vector<float> distances_from(const Size& size, const Eigen::Vector3d& spacing_mm, int threads,
                                  const Holds& holds) {
  std::vector<float> map(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                         static_cast<std::size_t>(size[2]));
  for (std::size_t c = 0; c < map.size(); ++c) map[c] = holds(c) ? 0 : no_feature;
  make_squared_distances(map, size, spacing_mm, threads);
  for (float& d : map) d = std::sqrt(d);
  return map;
}

/// Calls visit(cell, piece) for the cells of all pieces.
template <class Visit>
void for_cells(const VoxelPieces& pieces, const Size& size, const Visit& visit) {
  for (std::size_t row = 0; row + 1 < pieces.row_start.size(); ++row)
    for (std::size_t r = pieces.row_start[row]; r < pieces.row_start[row + 1]; ++r)
      for (int i = pieces.runs[r].first; i <= pieces.runs[r].last; ++i)
        visit(row * static_cast<std::size_t>(size[0]) + static_cast<std::size_t>(i),
              static_cast<std::size_t>(pieces.runs[r].piece));
}

/// The largest piece of the cells that hold.
template <class Holds>
Mask largest_part(const Size& size, std::size_t count, const Holds& holds, std::size_t& cells) {
  Mask mask(count, 0);
  for (std::size_t c = 0; c < count; ++c) mask[c] = holds(c);
  const VoxelPieces pieces = find_pieces(mask, size, 1, Connectivity::faces);
  const auto most = std::max_element(pieces.voxels.begin(), pieces.voxels.end());
  cells = most == pieces.voxels.end() ? 0 : *most;
  const auto best = static_cast<std::size_t>(most - pieces.voxels.begin());
  for_cells(pieces, size, [&](std::size_t c, std::size_t piece) { mask[c] = piece == best; });
  return mask;
}

/// Tissue near the core of the head, and parts farther off that end soon: ears, but no table.
void mark_head(HeadRegion& region, const Mask& solid, const Mask& core,
               const Eigen::Vector3d& cell_size_mm, int threads) {
  const std::vector<float> from_core = distances_from(region.size, cell_size_mm, threads,
                                                      [&](std::size_t c) { return core[c] != 0; });
  Mask farther(solid.size(), 0);
  region.head.assign(solid.size(), 0);
  for (std::size_t c = 0; c < solid.size(); ++c) {
    if (!solid[c]) continue;
    (from_core[c] <= close_mm ? region.head : farther)[c] = 1;
  }
  const VoxelPieces parts = find_pieces(farther, region.size, 1, Connectivity::faces);
  std::vector<std::size_t> full(parts.voxels.size(), 0);  // cells that tissue fills
  std::vector<float> most(parts.voxels.size(), 0), least(parts.voxels.size(), no_feature);
  for_cells(parts, region.size, [&](std::size_t c, std::size_t part) {
    most[part] = std::max(most[part], from_core[c]);
    least[part] = std::min(least[part], from_core[c]);
    full[part] += region.mean[c] > full_cell_hu;
  });
  const double touching_mm = close_mm + cell_size_mm.maxCoeff();
  for_cells(parts, region.size, [&](std::size_t c, std::size_t part) {
    const bool thick = static_cast<double>(full[part]) >=
                       least_full_fraction * static_cast<double>(parts.voxels[part]);
    if (thick && most[part] <= longest_part_mm && least[part] <= touching_mm) region.head[c] = 1;
  });
}

/// Marks the cells next to the head that are not solid: its surface runs through some of them.
void mark_edge(HeadRegion& region, const Mask& solid) {
  const int nx = region.size[0], ny = region.size[1], nz = region.size[2];
  const auto at = [&](int i, int j, int k) {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(ny) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(nx) +
           static_cast<std::size_t>(i);
  };
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (region.head[at(i, j, k)] != 1) continue;
        for (int z = std::max(k - 1, 0); z <= std::min(k + 1, nz - 1); ++z)
          for (int y = std::max(j - 1, 0); y <= std::min(j + 1, ny - 1); ++y)
            for (int x = std::max(i - 1, 0); x <= std::min(i + 1, nx - 1); ++x) {
              std::uint8_t& near = region.head[at(x, y, z)];
              if (near == 0 && !solid[at(x, y, z)]) near = 2;
            }
      }
}

/// A lattice that is longer at both ends of an axis; the border values continue there.
struct LongerLattice {
  Size size;         // of the original
  std::size_t axis;  // that is longer
  int margin;        // at each end
  Size longer = size;

  LongerLattice(const Size& original, std::size_t along, int by)
      : size(original), axis(along), margin(by) {
    longer[axis] += 2 * margin;
  }
  std::size_t count() const {
    return static_cast<std::size_t>(longer[0]) * static_cast<std::size_t>(longer[1]) *
           static_cast<std::size_t>(longer[2]);
  }
  std::array<int, 3> place(std::size_t c) const {
    const auto row = static_cast<std::size_t>(longer[0]),
               rows = static_cast<std::size_t>(longer[1]);
    return {static_cast<int>(c % row), static_cast<int>(c / row % rows),
            static_cast<int>(c / (row * rows))};
  }
  /// The original cell whose value a cell has.
  std::size_t original(std::size_t c) const {
    std::array<int, 3> at = place(c);
    at[axis] = std::clamp(at[axis] - margin, 0, size[axis] - 1);
    return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(at[1])) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(at[0]);
  }
};

/// Air and things around the head, from the sides of the scan: the neck ends at its lower end, and
/// airways with it. The scan goes on beyond its ends, so that air above the head counts.
void mark_outside(const Volume& volume, HeadRegion& region, const Eigen::Vector3d& cell_size_mm,
                  int threads) {
  Eigen::Index along_body = 0;
  volume.axes.row(2).cwiseAbs().maxCoeff(&along_body);
  const auto upward = static_cast<std::size_t>(along_body);
  const LongerLattice lattice(
      region.size, upward,
      static_cast<int>(std::ceil((opening_mm + 2) / cell_size_mm[along_body])) + 1);
  const std::size_t count = lattice.count();
  const std::vector<float> from_head =
      distances_from(lattice.longer, cell_size_mm, threads,
                     [&](std::size_t c) { return region.head[lattice.original(c)] == 1; });
  Mask away(count, 0);
  for (std::size_t c = 0; c < count; ++c) away[c] = from_head[c] > opening_mm;
  const VoxelPieces parts = find_pieces(away, lattice.longer, 1, Connectivity::faces);
  std::vector<std::uint8_t> at_side(parts.voxels.size(), 0);
  for_cells(parts, lattice.longer, [&](std::size_t c, std::size_t part) {
    const auto at = lattice.place(c);
    for (std::size_t a = 0; a < 3; ++a)
      if (a != upward && (at[a] == 0 || at[a] + 1 == lattice.longer[a])) at_side[part] = 1;
  });
  std::size_t largest = 0;
  for (std::size_t part = 0; part < at_side.size(); ++part)
    if (at_side[part]) largest = std::max(largest, parts.voxels[part]);
  Mask outer(count, 0);
  for_cells(parts, lattice.longer, [&](std::size_t c, std::size_t part) {
    outer[c] = at_side[part] && 10 * parts.voxels[part] >= largest;
  });
  region.has_outside = largest > 0;
  const std::vector<float> outer_mm = distances_from(lattice.longer, cell_size_mm, threads,
                                                     [&](std::size_t c) { return outer[c] != 0; });
  region.outer_mm.resize(region.head.size());
  for (std::size_t c = 0; c < count; ++c) {
    const int at = lattice.place(c)[upward] - lattice.margin;
    if (at >= 0 && at < region.size[upward]) region.outer_mm[lattice.original(c)] = outer_mm[c];
  }
}

}  // namespace

std::size_t HeadRegion::cell_of(int i, int j, int k) const {
  return (static_cast<std::size_t>(k / cell[2]) * static_cast<std::size_t>(size[1]) +
          static_cast<std::size_t>(j / cell[1])) *
             static_cast<std::size_t>(size[0]) +
         static_cast<std::size_t>(i / cell[0]);
}

bool HeadRegion::holds(int i, int j, int k) const {
  const std::size_t c = cell_of(i, j, k);
  return head[c] || outer_mm[c] > crease_depth_mm;
}

double HeadRegion::outer_distance(int i, int j, int k) const {
  const std::array<int, 3> at = {i, j, k};
  std::array<int, 3> low;
  std::array<double, 3> part;
  for (std::size_t a = 0; a < 3; ++a) {
    const double c = std::clamp((at[a] + 0.5) / cell[a] - 0.5, 0.0, size[a] - 1.0);
    low[a] = std::min(static_cast<int>(c), std::max(0, size[a] - 2));
    part[a] = c - low[a];
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    std::array<std::size_t, 3> place;
    double weight = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const int bit = corner >> a & 1;
      place[a] = static_cast<std::size_t>(std::min(low[a] + bit, size[a] - 1));
      weight *= bit ? part[a] : 1 - part[a];
    }
    if (weight <= 0) continue;
    sum += weight * outer_mm[(place[2] * static_cast<std::size_t>(size[1]) + place[1]) *
                                 static_cast<std::size_t>(size[0]) +
                             place[0]];
  }
  return sum;
}

HeadRegion find_head(const Volume& volume, const TissueLevels& levels, const std::string& name,
                     int threads, const Progress& progress) {
  report(progress, "finding the head", 0);
  HeadRegion region;
  average_cells(volume, region, threads);
  Eigen::Vector3d cell_size_mm = volume.spacing_mm;
  for (int a = 0; a < 3; ++a) cell_size_mm[a] *= region.cell[static_cast<std::size_t>(a)];

  Mask solid(region.mean.size());
  for (std::size_t c = 0; c < solid.size(); ++c) solid[c] = region.mean[c] > levels.skin();
  report(progress, "finding the head", 0.3);
  const std::vector<float> depth =
      distances_from(region.size, cell_size_mm, threads, [&](std::size_t c) { return !solid[c]; });
  std::size_t cells = 0;
  const Mask core = largest_part(
      region.size, solid.size(), [&](std::size_t c) { return depth[c] > core_depth_mm; }, cells);
  const double core_cm3 = static_cast<double>(cells) * cell_size_mm.prod() / 1000;
  if (core_cm3 < least_head_cm3)
    throw InputError(fmt::format(
        "{}: the largest body in the volume has {:.1f} cm3 of tissue deeper than {:g} mm, a head "
        "has at least {:g} cm3",
        name, core_cm3, core_depth_mm, least_head_cm3));
  report(progress, "finding the head", 0.6);
  mark_head(region, solid, core, cell_size_mm, threads);
  mark_outside(volume, region, cell_size_mm, threads);
  mark_edge(region, solid);
  report(progress, "finding the head", 1);
  return region;
}

VoxelBox box_of_cells(const Volume& volume, const HeadRegion& head,
                      const std::function<bool(std::size_t)>& holds, int margin_cells,
                      int margin_voxels) {
  std::array<int, 3> low, high = {-1, -1, -1};
  low.fill(std::numeric_limits<int>::max());
  std::size_t cell = 0;
  for (int k = 0; k < head.size[2]; ++k)
    for (int j = 0; j < head.size[1]; ++j)
      for (int i = 0; i < head.size[0]; ++i, ++cell) {
        if (!holds(cell)) continue;
        const std::array<int, 3> at = {i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], at[a]);
          high[a] = std::max(high[a], at[a]);
        }
      }
  VoxelBox box;
  if (high[0] < 0) return box;
  for (std::size_t a = 0; a < 3; ++a) {
    const int margin = margin_cells * head.cell[a] + margin_voxels;
    box.low[a] = low[a] * head.cell[a] - margin;
    box.size[a] = (high[a] + 1) * head.cell[a] + margin - box.low[a];
  }
  return box.within(whole_box(volume).grown(1));
}

}  // namespace condyle
