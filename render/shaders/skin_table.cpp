#include "render/shaders/skin_table.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace condyle {
namespace {

/// Light scattered this far in one direction, integrated over the other: the Gaussians of the plane
/// integrated over lines. (Applied to the ring directly, the wide red ones would nearly vanish.)
Eigen::Vector3d profile(double distance_mm) {
  struct Gaussian {
    double variance;
    Eigen::Vector3d weight;
  };
  static const Gaussian gaussians[] = {
      {0.0064, {0.233, 0.455, 0.649}}, {0.0484, {0.100, 0.336, 0.344}},
      {0.187, {0.118, 0.198, 0.000}},  {0.567, {0.113, 0.007, 0.007}},
      {1.99, {0.358, 0.004, 0.000}},   {7.41, {0.078, 0.000, 0.000}}};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& g : gaussians)
    sum += g.weight * (std::exp(-distance_mm * distance_mm / (2 * g.variance)) /
                       std::sqrt(2 * std::numbers::pi * g.variance));
  return sum;
}

}  // namespace

SkinTable make_skin_table() {
  constexpr int steps = 240;
  SkinTable table;
  table.rgb.resize(std::size_t{3} * SkinTable::width * SkinTable::height);
  for (int row = 0; row < SkinTable::height; ++row) {
    const double curvature =
        SkinTable::max_curvature * std::max(row, 1) / static_cast<double>(SkinTable::height - 1);
    const double radius_mm = 1 / curvature;
    // The profile is narrow on a large sphere: only the arc where it is significant is sampled.
    const double reach = std::min(std::numbers::pi, 9 / radius_mm);
    std::array<double, steps> turns;
    std::array<Eigen::Vector3d, steps> weights;
    Eigen::Vector3d whole = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < steps; ++i) {
      turns[i] = reach * (-1 + (2.0 * static_cast<double>(i) + 1) / steps);
      weights[i] = profile(2 * radius_mm * std::sin(std::abs(turns[i]) / 2));
      whole += weights[i];
    }
    for (int column = 0; column < SkinTable::width; ++column) {
      const double angle = std::acos(-1 + 2.0 * column / (SkinTable::width - 1));
      Eigen::Vector3d light = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < steps; ++i)
        light += std::max(0.0, std::cos(angle + turns[i])) * weights[i];
      for (int k = 0; k < 3; ++k)
        table.rgb[3 * (row * SkinTable::width + column) + k] =
            static_cast<std::uint8_t>(std::lround(255 * std::clamp(light[k] / whole[k], 0.0, 1.0)));
    }
  }
  return table;
}

}  // namespace condyle
