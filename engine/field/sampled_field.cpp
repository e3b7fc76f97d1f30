#include "engine/field/sampled_field.h"

#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// Fills samples [low, high) of one block: whole when the surface is out of reach, else by parts.
void fill_block(const FieldRecipe& recipe, const SamplingOptions& options, SampledField& field,
                const Vector3i& low, const Vector3i& high, const std::vector<int>& among) {
  const Eigen::AlignedBox3d box(field.position(low.x(), low.y(), low.z()),
                                field.position(high.x() - 1, high.y() - 1, high.z() - 1));
  const auto steps = recipe.steps_near(box, among);
  // One spacing more than the block: cells between two blocks belong to both.
  const double reach = 0.5 * box.diagonal().norm() + field.spacing;
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

double SampledField::operator()(const Vector3d& p) const {
  Vector3d g = (p - origin) / spacing;
  Vector3i cell;
  for (int a = 0; a < 3; ++a) {
    g[a] = std::clamp(g[a], 0.0, size[a] - 1.0);
    cell[a] = std::min(static_cast<int>(g[a]), std::max(size[a] - 2, 0));
    g[a] -= cell[a];
  }
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const int a = c & 1, b = (c >> 1) & 1, d = c >> 2;
    const double w = (a ? g.x() : 1 - g.x()) * (b ? g.y() : 1 - g.y()) * (d ? g.z() : 1 - g.z());
    if (w > 0) sum += w * values[index(cell.x() + a, cell.y() + b, cell.z() + d)];
  }
  return sum;
}

SampledField sample_field(const FieldRecipe& recipe, const Eigen::AlignedBox3d& box,
                          const SamplingOptions& options) {
  SampledField field;
  field.origin = box.min();
  field.spacing = options.spacing;
  for (int a = 0; a < 3; ++a)
    field.size[a] = static_cast<int>(std::ceil(box.sizes()[a] / options.spacing - 1e-9)) + 1;
  field.values.assign(field.index(field.size.x() - 1, field.size.y() - 1, field.size.z() - 1) + 1,
                      static_cast<float>(FieldRecipe::nothing));
  const int block = 16;
  const Vector3i blocks = (field.size.array() + block - 1) / block;
  const auto all = recipe.steps_near(unbounded_box());
  parallel_for(static_cast<std::size_t>(blocks.x() * blocks.y()), options.threads,
               [&](std::size_t column) {
                 const int i = static_cast<int>(column) / blocks.y();
                 const int j = static_cast<int>(column) % blocks.y();
                 for (int k = 0; k < blocks.z(); ++k) {
                   const Vector3i low = block * Vector3i(i, j, k);
                   const Vector3i high = (low.array() + block).matrix().cwiseMin(field.size);
                   fill_block(recipe, options, field, low, high, all);
                 }
               });
  return field;
}

}  // namespace condyle
