#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/field/recipe.h"

namespace condyle {

/// Signed distances on a regular grid; sample (i, j, k) lies at origin + spacing * (i, j, k).
struct SampledField {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // mm
  double spacing = 1;                                // mm
  Eigen::Vector3i size = Eigen::Vector3i::Zero();    // samples along each axis
  std::vector<float> values;                         // mm; k runs fastest

  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * static_cast<std::size_t>(size.y()) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size.z()) +
           static_cast<std::size_t>(k);
  }
  Eigen::Vector3d position(int i, int j, int k) const {
    return origin + spacing * Eigen::Vector3d(i, j, k);
  }
  /// Trilinear value; points outside take the nearest border value.
  double operator()(const Eigen::Vector3d& p) const;
};

struct SamplingOptions {
  double spacing = 0.65;  // mm
  double band = 0;  // mm: values are exact this near to the surface, farther ones keep the sign
  double steepest = 1.3;  // largest gradient of the recipe: what may be skipped depends on it
  int threads = 1;        // the samples have the same bits for any number
};

/// Samples a recipe on the grid that covers `box` (its low corner is a sample). Blocks that the
/// surface cannot reach are filled with one value.
SampledField sample_field(const FieldRecipe& recipe, const Eigen::AlignedBox3d& box,
                          const SamplingOptions& options);

}  // namespace condyle
