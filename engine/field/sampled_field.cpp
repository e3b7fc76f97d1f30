#include "engine/field/sampled_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// Fills samples [low, high) of one block: at once when the surface is out of reach, else by parts.
void fill_block(const FieldRecipe& recipe, const SamplingOptions& options, SampledField& field,
                const Vector3i& low, const Vector3i& high, const std::vector<int>& among) {
  const Eigen::AlignedBox3d box(field.position(low.x(), low.y(), low.z()),
                                field.position(high.x() - 1, high.y() - 1, high.z() - 1));
  const auto steps = recipe.steps_near(box, among);
  // One step more than the block: cells between two blocks belong to both.
  double step = 0;
  for (int a = 0; a < 3; ++a) {
    const auto& axis = field.axes[static_cast<std::size_t>(a)];
    const auto before = static_cast<std::size_t>(std::max(low[a] - 1, 0));
    const auto after = std::min(static_cast<std::size_t>(high[a]), axis.size() - 1);
    step = std::max({step, box.min()[a] - axis[before], axis[after] - box.max()[a]});
  }
  const double reach = 0.5 * box.diagonal().norm() + step;
  const double at_center = recipe.value(box.center(), steps);
  if (std::abs(at_center) > options.steepest * reach + options.band) {
    for (int i = low.x(); i < high.x(); ++i)
      for (int j = low.y(); j < high.y(); ++j) {
        const auto row = field.values.begin() + static_cast<std::ptrdiff_t>(field.index(i, j, 0));
        std::fill(row + low.z(), row + high.z(), static_cast<float>(at_center));
      }
    return;
  }
  const int part = 4;
  if ((high - low).maxCoeff() > part) {
    for (int i = low.x(); i < high.x(); i += part)
      for (int j = low.y(); j < high.y(); j += part)
        for (int k = low.z(); k < high.z(); k += part) {
          const Vector3i at(i, j, k);
          fill_block(recipe, options, field, at, (at.array() + part).matrix().cwiseMin(high),
                     steps);
        }
    return;
  }
  for (int i = low.x(); i < high.x(); ++i)
    for (int j = low.y(); j < high.y(); ++j)
      for (int k = low.z(); k < high.z(); ++k)
        field.values[field.index(i, j, k)] =
            static_cast<float>(recipe.value(field.position(i, j, k), steps));
}

}  // namespace

GridAxis even_axis(double low, double high, double spacing) {
  assert(low <= high && spacing > 0);
  const int steps = static_cast<int>(std::ceil((high - low) / spacing - 1e-9));
  GridAxis axis;
  for (int i = 0; i <= steps; ++i) axis.push_back(low + spacing * i);
  return axis;
}

GridAxis graded_axis(double low, double high, double coarse, double fine_low, double fine_high,
                     double fine) {
  assert(fine > 0 && coarse >= fine && fine_low <= fine_high);
  GridAxis axis{low};
  while (axis.back() < high) {
    const double outside = std::max({fine_low - axis.back(), axis.back() - fine_high, 0.0});
    axis.push_back(axis.back() + std::min(coarse, fine + 0.06 * outside));
  }
  return axis;
}

std::array<GridAxis, 3> even_grid(const Eigen::AlignedBox3d& box, double spacing) {
  return {even_axis(box.min().x(), box.max().x(), spacing),
          even_axis(box.min().y(), box.max().y(), spacing),
          even_axis(box.min().z(), box.max().z(), spacing)};
}

double SampledField::operator()(const Vector3d& p) const {
  assert(size().minCoeff() >= 2);
  assert(values.size() == axes[0].size() * axes[1].size() * axes[2].size());
  Vector3i cell;
  Vector3d part;
  for (int a = 0; a < 3; ++a) {
    const auto& axis = axes[static_cast<std::size_t>(a)];
    const auto above = std::upper_bound(axis.begin() + 1, axis.end() - 1, p[a]);
    cell[a] = static_cast<int>(above - axis.begin()) - 1;
    part[a] = std::clamp((p[a] - *(above - 1)) / (*above - *(above - 1)), 0.0, 1.0);
  }
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const int a = c & 1, b = (c >> 1) & 1, d = c >> 2;
    const double w = (a ? part.x() : 1 - part.x()) * (b ? part.y() : 1 - part.y()) *
                     (d ? part.z() : 1 - part.z());
    sum += w * values[index(cell.x() + a, cell.y() + b, cell.z() + d)];
  }
  return sum;
}

SampledField sample_field(const FieldRecipe& recipe, const std::array<GridAxis, 3>& axes,
                          const SamplingOptions& options) {
  SampledField field{axes, {}};
  const Vector3i size = field.size();
  field.values.assign(axes[0].size() * axes[1].size() * axes[2].size(),
                      static_cast<float>(FieldRecipe::nothing));
  const int block = 16;
  const Vector3i blocks = (size.array() + block - 1) / block;
  const auto all = recipe.steps_near(unbounded_box());
  parallel_for(static_cast<std::size_t>(blocks.x() * blocks.y()), options.threads,
               [&](std::size_t column) {
                 const int i = static_cast<int>(column) / blocks.y();
                 const int j = static_cast<int>(column) % blocks.y();
                 for (int k = 0; k < blocks.z(); ++k) {
                   const Vector3i low = block * Vector3i(i, j, k);
                   const Vector3i high = (low.array() + block).matrix().cwiseMin(size);
                   fill_block(recipe, options, field, low, high, all);
                 }
               });
  return field;
}

}  // namespace condyle
