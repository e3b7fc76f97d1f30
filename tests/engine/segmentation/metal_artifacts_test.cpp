#include "engine/segmentation/metal_artifacts.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

namespace condyle {
namespace {

using Eigen::Vector2d;

constexpr int width = 160, slices = 5, filled_slice = 2;
constexpr double pixel_mm = 0.7, metal_mm = 3;
const Vector2d test_fillings[] = {{-22, 4}, {20, -3}};

Vector2d place(int i, int j) {
  return pixel_mm * Vector2d(i - 0.5 * (width - 1), j - 0.5 * (width - 1));
}

bool in_metal(int i, int j) {
  return std::any_of(std::begin(test_fillings), std::end(test_fillings),
                     [&](const Vector2d& m) { return (place(i, j) - m).norm() < metal_mm; });
}

/// Soft tissue with a ring of bone, in air.
double plain_hu(int i, int j) {
  const double r = place(i, j).norm();
  return r > 50 ? -1000 : r > 36 && r < 40 ? 1200 : 50;
}

Volume plain_scan() {
  Volume scan;
  scan.size = {width, width, slices};
  scan.spacing_mm = {pixel_mm, pixel_mm, 1.5};
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < width; ++j)
      for (int i = 0; i < width; ++i)
        scan.values.push_back(static_cast<std::int16_t>(plain_hu(i, j)));
  return scan;
}

/// With two fillings in one slice, a dark band between them and bright rays out of both.
Volume filled_scan() {
  Volume scan = plain_scan();
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i) {
      double hu = plain_hu(i, j);
      for (const Vector2d& m : test_fillings) {
        const Vector2d from = place(i, j) - m;
        for (int ray = 0; ray < 6; ++ray) {
          const double angle = 0.3 + std::numbers::pi * ray / 6;
          const double off = from.x() * std::sin(angle) - from.y() * std::cos(angle);
          hu += (ray % 2 == 0 ? 900 : -700) * std::exp(-0.5 * off * off);
        }
      }
      if (in_metal(i, j)) hu = 3071;
      scan.values[scan.index(i, j, filled_slice)] =
          static_cast<std::int16_t>(std::clamp(hu, -1024., 3071.));
    }
  return scan;
}

/// Root mean square of the streaks, HU, farther than 3 mm from metal.
double streaks_hu(const Volume& scan) {
  double sum = 0;
  int count = 0;
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i) {
      double nearest = 1e9;
      for (const Vector2d& m : test_fillings) nearest = std::min(nearest, (place(i, j) - m).norm());
      if (nearest < metal_mm + 3 || place(i, j).norm() > 48) continue;
      sum += std::pow(scan.at(i, j, filled_slice) - plain_hu(i, j), 2);
      ++count;
    }
  return std::sqrt(sum / count);
}

TEST(MetalArtifacts, StreaksShrinkAndOtherSlicesKeepTheirBits) {
  const Volume scan = filled_scan();
  const auto corrected = reduce_metal_artifacts(scan, 2);
  ASSERT_TRUE(corrected);
  EXPECT_EQ(corrected->slices, 1);
  EXPECT_GT(streaks_hu(scan), 200);
  EXPECT_LT(streaks_hu(corrected->volume), 0.5 * streaks_hu(scan));
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < width; ++j)
      for (int i = 0; i < width; ++i)
        if (k != filled_slice) {
          ASSERT_EQ(corrected->volume.at(i, j, k), scan.at(i, j, k));
        } else if (in_metal(i, j)) {
          ASSERT_GE(corrected->volume.at(i, j, k), 2900);
        }
}

TEST(MetalArtifacts, TheBoneBetweenTheFillingsRemains) {
  const auto corrected = reduce_metal_artifacts(filled_scan(), 1);
  ASSERT_TRUE(corrected);
  double ring = 0, within = 0;
  int ring_count = 0, within_count = 0;
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i) {
      const double r = place(i, j).norm(), hu = corrected->volume.at(i, j, filled_slice);
      if (r > 37 && r < 39) ring += hu, ++ring_count;
      if (r < 12) within += hu, ++within_count;
    }
  EXPECT_NEAR(ring / ring_count, 1200, 150);
  EXPECT_NEAR(within / within_count, 50, 150);
}

TEST(MetalArtifacts, MetalBeyondTheScannersRangeIsFilled) {
  Volume scan = filled_scan();
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i) {
      std::int16_t& hu = scan.values[scan.index(i, j, filled_slice)];
      hu = std::min<std::int16_t>(hu, 2272);
      if ((place(i, j) - test_fillings[0]).norm() < 1) hu = -1000;  // overflow
    }
  const auto corrected = reduce_metal_artifacts(scan, 2);
  ASSERT_TRUE(corrected);
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i)
      if ((place(i, j) - test_fillings[0]).norm() < 1) {
        EXPECT_GE(corrected->volume.at(i, j, filled_slice), 2200);
      }
}

TEST(MetalArtifacts, AScanWithoutMetalOrWithThinEnamelIsLeftAlone) {
  EXPECT_FALSE(reduce_metal_artifacts(plain_scan(), 2));
  Volume enamel = plain_scan();
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i)
      if (std::abs(place(i, j).norm() - 30) < 0.7)
        enamel.values[enamel.index(i, j, filled_slice)] = 3000;
  EXPECT_FALSE(reduce_metal_artifacts(enamel, 2));
}

TEST(MetalArtifacts, PaddingBeyondTheFieldOfViewStays) {
  Volume scan = filled_scan();
  const std::size_t corner = scan.index(0, 0, filled_slice);
  scan.values[corner] = -2000;
  const auto corrected = reduce_metal_artifacts(scan, 2);
  ASSERT_TRUE(corrected);
  EXPECT_EQ(corrected->volume.values[corner], -2000);
}

TEST(MetalArtifacts, SlicesAreThoseAcrossTheVertical) {
  const Volume scan = filled_scan();
  Volume turned;  // the vertical is the first axis of the lattice
  turned.size = {slices, width, width};
  turned.spacing_mm = {1.5, pixel_mm, pixel_mm};
  turned.axes.col(0) = Eigen::Vector3d::UnitZ();
  turned.axes.col(1) = Eigen::Vector3d::UnitX();
  turned.axes.col(2) = Eigen::Vector3d::UnitY();
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i)
      for (int k = 0; k < slices; ++k) turned.values.push_back(scan.at(i, j, k));
  const auto upright = reduce_metal_artifacts(scan, 1), lying = reduce_metal_artifacts(turned, 1);
  ASSERT_TRUE(upright && lying);
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i)
      ASSERT_EQ(upright->volume.at(i, j, filled_slice), lying->volume.at(filled_slice, i, j));
}

TEST(MetalArtifacts, OblongAndFinePixelsAreCorrectedInBoundedTime) {
  // Each row for four: the streaks across it remain to be removed.
  const Volume scan = filled_scan();
  Volume oblong;
  oblong.size = {width, width / 4, slices};
  oblong.spacing_mm = {pixel_mm, 4 * pixel_mm, 1.5};
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < width / 4; ++j)
      for (int i = 0; i < width; ++i) oblong.values.push_back(scan.at(i, 4 * j + 1, k));
  const auto corrected = reduce_metal_artifacts(oblong, 2);
  ASSERT_TRUE(corrected);
  double before = 0, after = 0;
  for (int j = 0; j < width / 4; ++j)
    for (int i = 0; i < width; ++i) {
      if (place(i, 4 * j + 1).norm() > 34 || in_metal(i, 4 * j + 1)) continue;
      before += std::abs(oblong.at(i, j, filled_slice) - 50);
      after += std::abs(corrected->volume.at(i, j, filled_slice) - 50);
    }
  EXPECT_LT(after, 0.85 * before);
  Volume extreme = oblong;
  extreme.spacing_mm = {0.001, 100, 1.5};
  reduce_metal_artifacts(extreme, 2);
  extreme.spacing_mm = {100, 0.001, 1.5};
  reduce_metal_artifacts(extreme, 2);
}

TEST(MetalArtifacts, ASmallFillingIsFoundInPixelsOfAnySize) {
  for (const double mm : {0.3, 0.45, 0.6, 0.8, 1.0}) {
    const int across = static_cast<int>(40 / mm);
    Volume scan;
    scan.size = {across, across, 1};
    scan.spacing_mm = {mm, mm, 1};
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i)
        scan.values.push_back(std::hypot(mm * i - 20, mm * j - 20) < 2 ? 3071 : 50);
    EXPECT_TRUE(reduce_metal_artifacts(scan, 1)) << mm;
  }
}

TEST(MetalArtifacts, ManyThreadsGiveTheSameBitsAndTheWorkCanBeCancelled) {
  const Volume scan = filled_scan();
  EXPECT_EQ(reduce_metal_artifacts(scan, 1)->volume.values,
            reduce_metal_artifacts(scan, 3)->volume.values);
  EXPECT_THROW(reduce_metal_artifacts(
                   scan, 1, [](std::string_view, double) { throw std::runtime_error("stop"); }),
               std::runtime_error);
}

}  // namespace
}  // namespace condyle
