#include "sim/scanner/disturbances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/core/parallel.h"
#include "sim/scanner/ct_scan.h"
#include "sim/scanner/scanner_noise.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Calls change(p, value) for each voxel with its position.
template <class Change>
void for_voxels(Volume& volume, int threads, const Change& change) {
  parallel_for(static_cast<std::size_t>(volume.size[2]), threads, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < volume.size[1]; ++j)
      for (int i = 0; i < volume.size[0]; ++i)
        change(volume.position(i, j, k), volume.values[volume.index(i, j, k)]);
  });
}

/// The hindmost place of the head, y in mm.
double back_of(const ScannedHead& head) {
  double back = 0;
  for (double z = -20; z <= 80; z += 4)
    for (double x = -40; x <= 40; x += 8) {
      double y = 140;
      while (y > back && head.skin({x, y, z}) > 0) y -= 0.5;
      back = std::max(back, y);
    }
  return back;
}

constexpr double metal_radius = 2, metal_half_height = 2.5, streak_reach = 60;  // mm

struct Filling {
  Vector3d center;
  std::array<double, 12> angle, strength_hu;
};

/// Metal, or what its streaks add.
double with_filling(const Filling& filling, const Vector3d& p, double hu) {
  const Vector3d at = p - filling.center;
  const double r = std::hypot(at.x(), at.y());
  if (std::abs(at.z()) > metal_half_height || r > streak_reach) return hu;
  if (r < metal_radius) return most_stored_hu;
  const double direction = std::atan2(at.y(), at.x());
  double sum = 0;
  for (std::size_t n = 0; n < filling.angle.size(); ++n) {
    const double off = std::remainder(direction - filling.angle[n], std::numbers::pi) * r;
    sum += filling.strength_hu[n] * std::exp(-0.5 * off * off);
  }
  return hu + sum * (1 - std::abs(at.z()) / metal_half_height) * std::exp(-r / 25);
}

}  // namespace

void draw_table(const ScannedHead& head, int threads, Volume& volume) {
  constexpr double plastic_hu = 250, foam_hu = -880, rail_hu = 1500;
  constexpr double rest_radius = 95, foam_mm = 1, plastic_mm = 3;
  const double back = back_of(head);
  for_voxels(volume, threads, [&](const Vector3d& p, std::int16_t& value) {
    if (value > -900) return;  // the patient
    const double y = p.y() - back, r = std::hypot(p.x(), y + rest_radius) - rest_radius;
    if (r > 0 && y > -45) {
      if (r < foam_mm) value = foam_hu;
      if (r >= foam_mm && r < foam_mm + plastic_mm) value = plastic_hu;
    }
    if (y > 12 && y < 32 && std::abs(p.x()) < 100)
      value = y < 14 || y > 30 ? plastic_hu : foam_hu - 50;
    if (y > 16 && y < 24 && std::abs(std::abs(p.x()) - 70) < 4) value = rail_hu;
  });
}

void draw_fillings(const ScannedHead& head, std::uint64_t seed, int threads, Volume& volume) {
  constexpr double strongest_hu = 700;
  std::array<Filling, 3> fillings;
  const std::array<Vector3d, 3> centers = {head.place(HeadMap::mandible, {24, -50, -52}),
                                           head.place(HeadMap::mandible, {-23, -52, -53}),
                                           head.place(HeadMap::skull, {25, -55, -49})};
  for (std::size_t f = 0; f < fillings.size(); ++f) {
    fillings[f].center = centers[f];
    for (std::size_t n = 0; n < fillings[f].angle.size(); ++n) {
      fillings[f].angle[n] = std::numbers::pi * uniform_number(seed + 5, 100 * f + 2 * n);
      fillings[f].strength_hu[n] =
          strongest_hu * (2 * uniform_number(seed + 5, 100 * f + 2 * n + 1) - 1);
    }
  }
  for_voxels(volume, threads, [&](const Vector3d& p, std::int16_t& value) {
    double hu = value;
    for (const Filling& filling : fillings) hu = with_filling(filling, p, hu);
    value = stored_hu(hu);
  });
}

void add_noise(double sigma_hu, std::uint64_t seed, int threads, Volume& volume) {
  if (sigma_hu <= 0) return;
  const std::size_t slice =
      static_cast<std::size_t>(volume.size[0]) * static_cast<std::size_t>(volume.size[1]);
  parallel_for(static_cast<std::size_t>(volume.size[2]), threads, [&](std::size_t k) {
    for (std::size_t q = k * slice; q < (k + 1) * slice; ++q)
      volume.values[q] = stored_hu(volume.values[q] + sigma_hu * normal_number(seed, q));
  });
}

}  // namespace condyle
