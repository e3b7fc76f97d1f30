#include "engine/segmentation/marrow.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "engine/core/disjoint_sets.h"
#include "engine/core/parallel.h"
#include "engine/segmentation/voxel_pieces.h"

namespace condyle {
namespace {

constexpr double air_in_cavity_hu = -200;  // a cavity with a lower mean holds air, not marrow
constexpr double largest_marrow_mm3 = 50000;
constexpr double largest_cut_marrow_mm3 = 5000;  // of marrow that the end of the scan cuts open
constexpr double smallest_cavity_mm3 = 60;       // smaller ones are noise, or metal out of range

// Of cavities that pinholes open. source: `condyle bench import --only "dark marrow"`, where marrow
// has 0.8 % of open and airy faces together; a real head, where spaces outside bone have 20 % and
// more of open faces.
constexpr double least_core_mm3 = 30, least_leaking_mm3 = 300;
constexpr double thickest_mm = 6;        // 2 volume / wall: brain, cysts and sinuses are thicker
constexpr double most_open = 0.01;       // of the wall: a joint gap is open along its rim
constexpr double most_airy = 0.02;       // of the wall
constexpr std::size_t widest_hole = 16;  // voxels; holes are one or two voxels narrow
constexpr std::int16_t airy_hu = -300;   // next to this, cortex may be too thin to be seen
constexpr std::size_t most_cavities = 120;

constexpr VoxelLabel air = 253;  // among labels of this file

// Parts of the space without bone and air: cores lie apart from walls, rims between. The outside is
// number 1, cavities follow.
constexpr std::uint8_t no_part = 0, outside = 1, first_cavity = 2, rim = 128;
constexpr std::uint8_t number_of(std::uint8_t part) { return part & 127; }
static_assert(first_cavity + most_cavities <= rim);

using Voxels = std::vector<std::uint32_t>;

/// 1 where a voxel and its six neighbours are no bone and no air, or beyond the lattice.
std::vector<std::uint8_t> far_from_walls(const std::vector<VoxelLabel>& label,
                                         const std::array<int, 3>& size, int threads) {
  static_assert(no_bone == 0);
  std::vector<std::uint8_t> far(label.size());
  const auto nx = static_cast<std::size_t>(size[0]), ny = static_cast<std::size_t>(size[1]),
             nz = static_cast<std::size_t>(size[2]);
  parallel_for(nz, threads, [&](std::size_t k) {
    const auto row = [&](std::size_t y, std::size_t z) { return label.data() + (z * ny + y) * nx; };
    std::vector<std::uint8_t> any(nx);
    for (std::size_t j = 0; j < ny; ++j) {
      const VoxelLabel* here = row(j, k);
      std::copy_n(here, nx, any.begin());
      for (const VoxelLabel* other : {row(j == 0 ? 0 : j - 1, k), row(std::min(j + 1, ny - 1), k),
                                      row(j, k == 0 ? 0 : k - 1), row(j, std::min(k + 1, nz - 1))})
        for (std::size_t i = 0; i < nx; ++i) any[i] = static_cast<std::uint8_t>(any[i] | other[i]);
      std::uint8_t* out = far.data() + (k * ny + j) * nx;
      for (std::size_t i = 0; i < nx; ++i)
        out[i] = (any[i] | here[i == 0 ? 0 : i - 1] | here[std::min(i + 1, nx - 1)]) == 0;
    }
  });
  return far;
}

class MarrowFill {
 public:
  MarrowFill(const Volume& volume, int threads, BoneVoxels& bone)
      : bone_(bone),
        inside_(bone.box.within(whole_box(volume))),
        spacing_mm_(volume.spacing_mm),
        voxel_mm3_(volume.spacing_mm.prod()),
        threads_(threads),
        bright_(static_cast<std::int16_t>(std::ceil(bone.threshold_hu) + 1)),
        label_(inside_.count()) {
    assert(label_.size() <= std::numeric_limits<std::uint32_t>::max());
    for (int k = 0; k < inside_.size[2]; ++k)
      for (int j = 0; j < inside_.size[1]; ++j)
        std::copy_n(bone.label.data() + place(0, j, k), inside_.size[0],
                    label_.data() + inside_.index(0, j, k));
  }

  /// Fills cavities without a hole. One at the end of the scan ends there: it is not joined with
  /// the outside.
  void fill_enclosed() {
    const VoxelPieces pieces = find_pieces(label_, inside_.size, no_bone, Connectivity::faces);
    std::vector<double> sum(pieces.voxels.size(), 0);
    for_voxels(pieces, [&](std::size_t piece, std::size_t, std::size_t at) {
      sum[piece] += bone_.smooth[at];
    });
    std::vector<std::uint8_t> filled(pieces.voxels.size(), 0);
    for (std::size_t piece = 0; piece < filled.size(); ++piece) {
      const auto voxels = static_cast<double>(pieces.voxels[piece]);
      const double mm3 = voxels * voxel_mm3_;
      const bool holds_air = sum[piece] < air_in_cavity_hu * voxels;
      filled[piece] =
          mm3 <= (pieces.at_border[piece] ? largest_cut_marrow_mm3 : largest_marrow_mm3) &&
          (!holds_air || (mm3 <= smallest_cavity_mm3 && !pieces.at_border[piece]));
    }
    for_voxels(pieces, [&](std::size_t piece, std::size_t q, std::size_t at) {
      if (filled[piece]) fill(q, at);
    });
  }

  /// Fills cavities with pinholes. Returns whether there are any.
  bool fill_leaking() {
    mark_air();
    std::vector<std::uint8_t> part = far_from_walls(label_, inside_.size, threads_);
    const bool any = number_cores(part) && fill_cavities(part, grow_cores(part));
    unmark_air();
    return any;
  }

 private:
  /// A cavity up to the middles of its holes.
  struct Cavity {
    std::size_t voxels = 0;
    std::size_t walls = 0, open = 0, airy = 0;  // faces to bone, to what is not filled, to air
    double wall_mm2 = 0;
    Voxels holes;  // those at open faces
    bool filled = true;
  };

  template <class Change>
  void for_rows(const Change& change) const {
    parallel_for(static_cast<std::size_t>(inside_.size[2]), threads_, [&](std::size_t slice) {
      const int k = static_cast<int>(slice);
      for (int j = 0; j < inside_.size[1]; ++j) change(k, inside_.index(0, j, k), place(0, j, k));
    });
  }
  void mark_air() {
    for_rows([&](int, std::size_t q, std::size_t at) {
      for (const std::size_t end = q + static_cast<std::size_t>(inside_.size[0]); q < end;
           ++q, ++at)
        if (label_[q] == no_bone && bone_.smooth[at] < airy_hu) label_[q] = air;
    });
  }
  void unmark_air() {
    for_rows([&](int, std::size_t q, std::size_t) {
      const auto row = label_.begin() + static_cast<std::ptrdiff_t>(q);
      std::replace(row, row + inside_.size[0], air, no_bone);
    });
  }
  bool number_cores(std::vector<std::uint8_t>& part) const;
  Voxels grow_cores(std::vector<std::uint8_t>& part) const;
  bool fill_cavities(const std::vector<std::uint8_t>& part, const Voxels& rims);
  void find_holes(const std::vector<std::uint8_t>& part, const Voxels& rims,
                  std::vector<Cavity>& cavities) const;
  bool is_marrow(const Cavity& cavity) const;

  std::size_t place(int i, int j, int k) const {
    return bone_.box.index(inside_.low[0] - bone_.box.low[0] + i,
                           inside_.low[1] - bone_.box.low[1] + j,
                           inside_.low[2] - bone_.box.low[2] + k);
  }
  std::array<int, 3> at_of(std::size_t q) const {
    const auto nx = static_cast<std::size_t>(inside_.size[0]),
               ny = static_cast<std::size_t>(inside_.size[1]);
    return {static_cast<int>(q % nx), static_cast<int>(q / nx % ny), static_cast<int>(q / nx / ny)};
  }
  /// Calls visit(piece, voxel of this lattice, voxel of the bone's box).
  template <class Visit>
  void for_voxels(const VoxelPieces& pieces, const Visit& visit) const {
    for_runs(pieces, inside_.size[0], [&](std::size_t q, const VoxelRun& run) {
      const auto row = static_cast<int>(q / static_cast<std::size_t>(inside_.size[0]));
      const std::size_t at = place(run.first, row % inside_.size[1], row / inside_.size[1]);
      const auto count = static_cast<std::size_t>(run.last - run.first + 1);
      for (std::size_t i = 0; i < count; ++i)
        visit(static_cast<std::size_t>(run.piece), q + i, at + i);
    });
  }
  /// Calls visit(neighbour, axis of the face) for the neighbours of a voxel within the lattice.
  template <class Visit>
  void for_neighbours(std::size_t q, const Visit& visit) const {
    const std::array<int, 3> at = at_of(q);
    std::size_t step = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (at[axis] > 0) visit(q - step, axis);
      if (at[axis] + 1 < inside_.size[axis]) visit(q + step, axis);
      step *= static_cast<std::size_t>(inside_.size[axis]);
    }
  }
  void fill(std::size_t q, std::size_t at) {
    label_[q] = bone_.label[at] = 1;
    bone_.smooth[at] = std::max(bone_.smooth[at], bright_);
  }
  std::size_t largest_hole(Voxels holes) const;

  BoneVoxels& bone_;
  VoxelBox inside_;
  Eigen::Vector3d spacing_mm_;
  double voxel_mm3_;
  int threads_;
  std::int16_t bright_;
  std::vector<VoxelLabel> label_;  // of the box within the volume
};

/// Voxels of the largest group of neighbours.
std::size_t MarrowFill::largest_hole(Voxels holes) const {
  std::sort(holes.begin(), holes.end());
  holes.erase(std::unique(holes.begin(), holes.end()), holes.end());
  DisjointSets sets(holes.size());
  std::vector<std::array<int, 3>> at;
  for (const std::uint32_t q : holes) at.push_back(at_of(q));
  for (std::size_t a = 0; a < holes.size(); ++a)
    for (std::size_t b = a + 1; b < holes.size() && at[b][2] <= at[a][2] + 1; ++b)
      if (std::abs(at[a][0] - at[b][0]) <= 1 && std::abs(at[a][1] - at[b][1]) <= 1)
        sets.join(static_cast<int>(a), static_cast<int>(b));
  std::vector<std::size_t> size(holes.size(), 0);
  for (std::size_t a = 0; a < holes.size(); ++a)
    ++size[static_cast<std::size_t>(sets.find(static_cast<int>(a)))];
  return size.empty() ? 0 : *std::max_element(size.begin(), size.end());
}

/// Numbers the cores in a mask of what is far from walls. Returns whether there are cavities.
bool MarrowFill::number_cores(std::vector<std::uint8_t>& part) const {
  const VoxelPieces pieces = find_pieces(part, inside_.size, 1, Connectivity::faces);
  std::vector<std::size_t> cores;
  for (std::size_t piece = 0; piece < pieces.voxels.size(); ++piece)
    if (!pieces.at_border[piece] &&
        static_cast<double>(pieces.voxels[piece]) * voxel_mm3_ >= least_core_mm3)
      cores.push_back(piece);
  std::stable_sort(cores.begin(), cores.end(), [&](std::size_t a, std::size_t b) {
    return pieces.voxels[a] > pieces.voxels[b];
  });
  if (cores.size() > most_cavities) cores.resize(most_cavities);
  std::vector<std::uint8_t> number(pieces.voxels.size(), no_part);
  for (std::size_t piece = 0; piece < number.size(); ++piece)
    if (pieces.at_border[piece]) number[piece] = outside;
  for (std::size_t n = 0; n < cores.size(); ++n)
    number[cores[n]] = static_cast<std::uint8_t>(first_cavity + n);
  for_runs(pieces, inside_.size[0], [&](std::size_t q, const VoxelRun& run) {
    const std::uint8_t here = number[static_cast<std::size_t>(run.piece)];
    if (here != outside)
      std::fill_n(part.begin() + static_cast<std::ptrdiff_t>(q), run.last - run.first + 1, here);
  });
  return !cores.empty();
}

/// Shares out what is near walls to the nearest core. Returns the rims of cavities.
Voxels MarrowFill::grow_cores(std::vector<std::uint8_t>& part) const {
  const auto core_beside = [&](std::size_t q) {
    std::uint8_t beside = no_part;
    for_neighbours(q, [&](std::size_t other, std::size_t) {
      if (part[other] < rim) beside = std::max(beside, part[other]);
    });
    return beside;
  };
  Voxels grown, rims;
  {
    // Cavities come first, so that their holes end at the core of the outside.
    std::vector<std::array<Voxels, 2>> fronts(static_cast<std::size_t>(inside_.size[2]));
    for_rows([&](int k, std::size_t first, std::size_t) {
      const std::size_t end = first + static_cast<std::size_t>(inside_.size[0]);
      for (std::size_t q = first; q < end; ++q) {
        if (label_[q] != no_bone || part[q] != no_part) continue;
        const std::uint8_t beside = core_beside(q);
        if (beside != no_part)
          fronts[static_cast<std::size_t>(k)][beside == outside].push_back(
              static_cast<std::uint32_t>(q));
      }
    });
    for (const std::size_t which : {0, 1})
      for (const auto& front : fronts)
        grown.insert(grown.end(), front[which].begin(), front[which].end());
  }
  const auto take = [&](std::uint32_t q, std::uint8_t number) {
    part[q] = static_cast<std::uint8_t>(number | rim);
    if (number != outside) rims.push_back(q);
  };
  for (const std::uint32_t q : grown) take(q, core_beside(q));
  for (std::size_t n = 0; n < grown.size(); ++n) {
    const std::uint8_t number = number_of(part[grown[n]]);
    for_neighbours(grown[n], [&](std::size_t other, std::size_t) {
      if (label_[other] != no_bone || part[other] != no_part) return;
      take(static_cast<std::uint32_t>(other), number);
      grown.push_back(static_cast<std::uint32_t>(other));
    });
  }
  return rims;
}

/// Finds the faces of cavities to air, and to what is not filled.
void MarrowFill::find_holes(const std::vector<std::uint8_t>& part, const Voxels& rims,
                            std::vector<Cavity>& cavities) const {
  for (Cavity& cavity : cavities) {
    cavity.open = cavity.airy = 0;
    cavity.holes.clear();
  }
  const auto fills = [&](std::uint8_t number) {
    return number >= first_cavity && cavities[number - first_cavity].filled;
  };
  for (const std::uint32_t q : rims) {
    const std::uint8_t number = number_of(part[q]);
    Cavity& cavity = cavities[number - first_cavity];
    bool hole = false;
    for_neighbours(q, [&](std::size_t other, std::size_t) {
      const std::uint8_t beyond = number_of(part[other]);
      if (label_[other] == air) {
        ++cavity.airy;
      } else if (label_[other] == no_bone && beyond != number && !fills(beyond)) {
        ++cavity.open;
        hole = true;
      }
      // A core lies beside rims alone: its faces to that of another cavity are found here.
      if (beyond != number && !cavity.filled && part[other] >= first_cavity && part[other] < rim) {
        ++cavities[beyond - first_cavity].open;
        cavities[beyond - first_cavity].holes.push_back(q);
      }
    });
    const std::array<int, 3> at = at_of(q);
    for (std::size_t a = 0; a < 3; ++a)
      if (at[a] == 0 || at[a] + 1 == inside_.size[a]) {
        ++cavity.open;
        hole = true;
      }
    if (hole) cavity.holes.push_back(q);
  }
}

bool MarrowFill::is_marrow(const Cavity& cavity) const {
  const double mm3 = static_cast<double>(cavity.voxels) * voxel_mm3_;
  const auto walls = static_cast<double>(cavity.walls);
  return mm3 >= least_leaking_mm3 && 2 * mm3 <= thickest_mm * cavity.wall_mm2 &&
         static_cast<double>(cavity.open) <= most_open * walls &&
         static_cast<double>(cavity.airy) <= most_airy * walls &&
         largest_hole(cavity.holes) <= widest_hole;
}

bool MarrowFill::fill_cavities(const std::vector<std::uint8_t>& part, const Voxels& rims) {
  std::array<std::size_t, 256> voxels{};
  for (const std::uint8_t p : part) ++voxels[p];
  std::vector<Cavity> cavities;
  for (std::size_t number = first_cavity; voxels[number] > 0; ++number)
    cavities.emplace_back().voxels = voxels[number] + voxels[number | rim];
  for (const std::uint32_t q : rims) {
    Cavity& cavity = cavities[number_of(part[q]) - first_cavity];
    for_neighbours(q, [&](std::size_t other, std::size_t axis) {
      if (label_[other] != 1) return;
      ++cavity.walls;
      cavity.wall_mm2 += voxel_mm3_ / spacing_mm_[static_cast<Eigen::Index>(axis)];
    });
  }
  // Once one is not filled, it is open space for its neighbours.
  for (bool changed = true; changed;) {
    changed = false;
    find_holes(part, rims, cavities);
    for (Cavity& cavity : cavities) {
      if (!cavity.filled || is_marrow(cavity)) continue;
      cavity.filled = false;
      changed = true;
    }
  }
  if (std::none_of(cavities.begin(), cavities.end(), [](const Cavity& c) { return c.filled; }))
    return false;
  for_rows([&](int, std::size_t q, std::size_t at) {
    for (const std::size_t end = q + static_cast<std::size_t>(inside_.size[0]); q < end;
         ++q, ++at) {
      const std::uint8_t number = number_of(part[q]);
      if (number >= first_cavity && cavities[number - first_cavity].filled) fill(q, at);
    }
  });
  return true;
}

}  // namespace

void fill_marrow(const Volume& volume, int threads, BoneVoxels& bone) {
  MarrowFill marrow(volume, threads, bone);
  marrow.fill_enclosed();
  if (marrow.fill_leaking()) marrow.fill_enclosed();
}

}  // namespace condyle
