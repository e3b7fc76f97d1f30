#pragma once

#include <vector>

#include "sim/scanner/block_fields.h"
#include "sim/scanner/ct_scan.h"

namespace condyle {

/// Hounsfield units and tissues of a block of voxels, without blur and noise. Only for this module.
struct BlockScan {
  std::vector<float> hu;
  std::vector<ScanTissue> tissue;
};

/// `voxel_mm`: the edge of a cube of a voxel's volume.
BlockScan scan_block(const ScannedHead& head, const CtSettings& settings,
                     const std::vector<Eigen::Vector3d>& points, const std::array<int, 3>& size,
                     double voxel_mm);

}  // namespace condyle
