#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "engine/field/recipe.h"

namespace condyle {

/// The places of a block of voxels, at which fields are sampled. Only for this module.
struct BlockPlaces {
  struct Part {  // a few neighbouring voxels
    std::vector<int> points;
    Eigen::AlignedBox3d box;
  };
  std::vector<Eigen::Vector3d> points;
  std::vector<Part> parts;
  Eigen::AlignedBox3d box;

  /// size: voxels along each axis; the first axis is fastest in `points`.
  BlockPlaces(std::vector<Eigen::Vector3d> places, const std::array<int, 3>& size);
  BlockPlaces mirrored_x() const;
};

/// Values of a field at the places of a block, exact within `band_mm` of its surface and of the
/// right sign beyond. False, and `values` is unchanged, when the whole block lies outside.
bool sample_block(const FieldRecipe& recipe, const BlockPlaces& block, double band_mm,
                  std::vector<float>& values);

}  // namespace condyle
