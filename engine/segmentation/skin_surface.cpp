#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/self_crossings.h"
#include "engine/mesh/unfold.h"
#include "engine/segmentation/half_way.h"
#include "engine/segmentation/lattice_surface.h"
#include "engine/segmentation/metal_streaks.h"
#include "engine/volume/blur.h"

namespace condyle {
namespace {

constexpr double skin_blur_voxels = 0.6, lattice_step_mm = 0.95;
constexpr std::int16_t air_hu = -1000;
constexpr double least_skin_mm3 = 20000;  // of a piece

/// The scan without what lies around the head, and with cavities filled: as if the head were one
/// solid.
Volume solid_head(const Volume& volume, const TissueLevels& levels, const HeadRegion& head,
                  const VoxelBox& box, int threads) {
  Volume solid;
  solid.size = box.size;
  solid.spacing_mm = volume.spacing_mm;
  solid.axes = volume.axes;
  solid.origin = box.position(volume, 0, 0, 0);
  solid.values.assign(box.count(), air_hu);
  const auto soft = static_cast<std::int16_t>(std::lround(levels.soft));
  const double cell_mm =
      (volume.spacing_mm.array() * Eigen::Array3d(head.cell[0], head.cell[1], head.cell[2]))
          .matrix()
          .norm();
  const double limit = HeadRegion::crease_depth_mm;
  parallel_for(static_cast<std::size_t>(box.size[2]), threads, [&](std::size_t slice) {
    const int z = box.low[2] + static_cast<int>(slice);
    if (z < 0 || z >= volume.size[2]) return;
    for (int j = 0; j < box.size[1]; ++j) {
      const int y = box.low[1] + j;
      if (y < 0 || y >= volume.size[1]) continue;
      for (int i = 0; i < box.size[0]; ++i) {
        const int x = box.low[0] + i;
        if (x < 0 || x >= volume.size[0]) continue;
        const std::int16_t value = volume.at(x, y, z);
        const std::size_t c = head.cell_of(x, y, z);
        std::int16_t& out = solid.values[solid.index(i, j, static_cast<int>(slice))];
        if (head.head[c] && value > levels.skin()) {
          out = value;
          continue;
        }
        const double at_cell = head.outer_mm[c];
        const bool deep = at_cell > limit + cell_mm ||
                          (at_cell > limit - cell_mm && head.outer_distance(x, y, z) > limit);
        if (deep)
          out = std::max(value, soft);
        else if (value <= levels.skin())
          out = value;
        else
          out = air_hu;  // table, head rest
      }
    }
  });
  return solid;
}

/// Level minus the blurred scan on a lattice with steps of about 0.9 mm, on which the skin has all
/// its detail; the surface gets its place from the scan itself later.
std::vector<float> skin_values(const Volume& solid, double level, int threads, Volume& lattice) {
  std::array<int, 3> stride;
  lattice.spacing_mm = solid.spacing_mm;
  lattice.axes = solid.axes;
  lattice.origin = solid.origin;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    stride[a] = std::max(1, static_cast<int>(lattice_step_mm / solid.spacing_mm[axis]));
    lattice.size[a] = (solid.size[a] - 1) / stride[a] + 2;
    lattice.spacing_mm[axis] *= stride[a];
  }
  std::vector<std::int16_t> smooth = solid.values;
  blur(smooth, solid.size, skin_blur_voxels * *std::min_element(stride.begin(), stride.end()),
       threads);
  const auto [nx, ny, nz] = lattice.size;
  std::vector<float> values(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
                            static_cast<std::size_t>(nz));
  parallel_for(static_cast<std::size_t>(nz), threads, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < lattice.size[1]; ++j)
      for (int i = 0; i < lattice.size[0]; ++i) {
        const std::array<int, 3> at = {i * stride[0], j * stride[1], k * stride[2]};
        bool border = false;
        for (std::size_t a = 0; a < 3; ++a)
          border = border || at[a] == 0 || at[a] + 1 >= solid.size[a];
        values[lattice.index(i, j, k)] =
            border ? 1000 : static_cast<float>(level - smooth[solid.index(at[0], at[1], at[2])]);
      }
  });
  return values;
}

}  // namespace

ScanSurface skin_surface(const Volume& volume, const TissueLevels& levels, const HeadRegion& head,
                         const std::optional<MetalSlab>& metal, const std::string& name,
                         const SurfaceOptions& options, const Progress& progress) {
  if (!head.has_outside)
    throw InputError(
        fmt::format("{}: no air around the head: its skin lies outside the field of view", name));
  report(progress, "finding the skin", 0);
  const VoxelBox box = box_of_cells(
      volume, head, [&](std::size_t cell) { return head.head[cell] != 0; }, 1, 0);
  Volume solid = solid_head(volume, levels, head, box, options.threads);
  if (metal)
    trim_streaks(*metal, levels.skin(), static_cast<std::int16_t>(std::lround(levels.soft)),
                 box.low[static_cast<std::size_t>(metal->axis)], solid, options.threads);
  report(progress, "finding the skin", 0.3);
  Volume lattice;  // of the surface
  std::vector<float> values = skin_values(solid, levels.skin(), options.threads, lattice);
  report(progress, "finding the skin", 0.5);
  ScanSurface surface;
  surface.mesh = lattice_surface(lattice, whole_box(lattice), std::move(values),
                                 std::max(options.least_piece_mm3, least_skin_mm3));
  report(progress, "finding the skin", 1);
  const std::vector<Eigen::Vector3d> before = surface.mesh.vertices;
  surface.moved_fraction = move_to_half_way(
      surface.mesh, solid,
      {.threshold_hu = levels.skin(), .rise_hu = 300, .drop_hu = 200, .threads = options.threads},
      progress);
  uncross(surface.mesh, before, options.threads);
  unfold(surface.mesh, {.most_mm = 0.5 * volume.spacing_mm.minCoeff()});
  decimate_surface(surface, Flaws::folds, options, progress);
  return surface;
}

}  // namespace condyle
