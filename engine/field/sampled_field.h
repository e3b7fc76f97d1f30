#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/field/recipe.h"

namespace condyle {

/// Positions of the samples along one axis, mm, increasing.
using GridAxis = std::vector<double>;

/// Evenly spaced, from `low` to `high` or just beyond.
GridAxis even_axis(double low, double high, double spacing);

/// Finer inside an interval: steps grow smoothly from `fine` inside [fine_low, fine_high] to
/// `coarse`.
GridAxis graded_axis(double low, double high, double coarse, double fine_low, double fine_high,
                     double fine);

/// Signed distances on a grid of straight lines; sample (i, j, k) lies at axes x[i], y[j], z[k].
struct SampledField {
  std::array<GridAxis, 3> axes;
  std::vector<float> values;  // mm; k varies fastest

  Eigen::Vector3i size() const {
    return {static_cast<int>(axes[0].size()), static_cast<int>(axes[1].size()),
            static_cast<int>(axes[2].size())};
  }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * axes[1].size() + static_cast<std::size_t>(j)) *
               axes[2].size() +
           static_cast<std::size_t>(k);
  }
  Eigen::Vector3d position(int i, int j, int k) const {
    return {axes[0][static_cast<std::size_t>(i)], axes[1][static_cast<std::size_t>(j)],
            axes[2][static_cast<std::size_t>(k)]};
  }
  /// Trilinear value; points outside take the nearest border value.
  double operator()(const Eigen::Vector3d& p) const;
};

struct SamplingOptions {
  double band =
      0;  // mm: values are exact within this distance of the surface; beyond, their sign is right
  double steepest = 1.3;  // largest gradient of the recipe; decides which blocks are skipped
  int threads = 1;        // the samples are bit-identical for any number
};

/// Samples a recipe. Blocks that the surface cannot reach are filled with one value.
SampledField sample_field(const FieldRecipe& recipe, const std::array<GridAxis, 3>& axes,
                          const SamplingOptions& options = {});

/// Evenly spaced samples that cover the box.
std::array<GridAxis, 3> even_grid(const Eigen::AlignedBox3d& box, double spacing);

}  // namespace condyle
