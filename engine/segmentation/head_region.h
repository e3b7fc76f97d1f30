#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/core/progress.h"
#include "engine/segmentation/tissue_levels.h"
#include "engine/segmentation/voxel_box.h"
#include "engine/volume/volume.h"

namespace condyle {

/// Where the head lies in a scan, on a lattice of cells of about 2 mm. Table, head rest and tubes
/// belong to the outside.
struct HeadRegion {
  std::array<int, 3> cell = {1, 1, 1};  // voxels along each axis of a cell
  std::array<int, 3> size = {0, 0, 0};  // cells
  std::vector<std::int16_t> mean;       // HU
  std::vector<std::uint8_t> head;       // 1: tissue of the head; 2: air next to it; 0: others
  std::vector<float> outer_mm;          // distance of a cell from the air around the head
  bool has_outside = false;             // whether there is air around the head

  /// Air is outside the skin up to this distance from the air around the head: into the creases of
  /// the face, but not through nostrils and lips.
  static constexpr double crease_depth_mm = 10;

  std::size_t cell_of(int i, int j, int k) const;
  /// Whether a voxel lies in tissue of the head or in a cavity.
  bool holds(int i, int j, int k) const;
  /// outer_mm between the centres of cells.
  double outer_distance(int i, int j, int k) const;
};

/// throws: InputError naming the scan when nothing in it is as thick as a head.
HeadRegion find_head(const Volume& volume, const TissueLevels& levels, const std::string& name,
                     int threads, const Progress& progress = {});

/// The voxels of the cells that a test of their numbers holds for, with a margin of so many cells
/// and voxels, at most one voxel beyond the volume. Empty where it holds for none.
VoxelBox box_of_cells(const Volume& volume, const HeadRegion& head,
                      const std::function<bool(std::size_t)>& holds, int margin_cells,
                      int margin_voxels);

}  // namespace condyle
