#include "sim/scanner/block_fields.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

constexpr double steepest = 1.3;  // largest gradient of the recipes
constexpr int part_size = 4;      // voxels along each axis

/// Whether all of the box lies farther than the band from the surface, by the value at its centre.
bool far_from(const Eigen::AlignedBox3d& box, double at_center, double band_mm) {
  return std::abs(at_center) > steepest * 0.5 * box.diagonal().norm() + band_mm;
}

}  // namespace

BlockPlaces::BlockPlaces(std::vector<Eigen::Vector3d> places, const std::array<int, 3>& size)
    : points(std::move(places)) {
  std::array<int, 3> count;
  for (std::size_t a = 0; a < 3; ++a) count[a] = (size[a] + part_size - 1) / part_size;
  parts.resize(static_cast<std::size_t>(count[0] * count[1] * count[2]));
  int at = 0;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i, ++at) {
        Part& part = parts[static_cast<std::size_t>(
            (k / part_size * count[1] + j / part_size) * count[0] + i / part_size)];
        part.points.push_back(at);
        part.box.extend(points[static_cast<std::size_t>(at)]);
      }
  for (const Part& part : parts) box.extend(part.box);
}

BlockPlaces BlockPlaces::mirrored_x() const {
  BlockPlaces image = *this;
  const auto mirror = [](Eigen::AlignedBox3d& of) {
    const double low = of.min().x();
    of.min().x() = -of.max().x();
    of.max().x() = -low;
  };
  for (auto& p : image.points) p.x() = -p.x();
  for (auto& part : image.parts) mirror(part.box);
  mirror(image.box);
  return image;
}

bool sample_block(const FieldRecipe& recipe, const BlockPlaces& block, double band_mm,
                  std::vector<float>& values) {
  const std::vector<int> steps = recipe.steps_near(block.box);
  const double at_center = recipe.value(block.box.center(), steps);
  const bool uniform = far_from(block.box, at_center, band_mm);
  if (uniform && at_center > 0) return false;
  values.assign(block.points.size(), static_cast<float>(at_center));
  if (uniform) return true;
  for (const auto& part : block.parts) {
    const std::vector<int> near = recipe.steps_near(part.box, steps);
    const double here = recipe.value(part.box.center(), near);
    const bool even = far_from(part.box, here, band_mm);
    for (const int q : part.points) {
      const auto at = static_cast<std::size_t>(q);
      values[at] = static_cast<float>(even ? here : recipe.value(block.points[at], near));
    }
  }
  return true;
}

}  // namespace condyle
