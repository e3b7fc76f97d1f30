// Slices of a CT as they are shown: their directions, outlines and pixels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/ct_session/slice_outlines.h"
#include "sim/ct_session/slice_picture.h"
#include "sim/ct_session/solid_picture.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Values that tell where they lie: 1 per mm to the left, 20 to the back, 400 upward.
double value_at(const Vector3d& p) { return p.x() + 20 * p.y() + 400 * p.z(); }

/// A lattice whose axes point down, to the right and to the back.
Volume turned_volume() {
  Volume volume;
  volume.size = {5, 7, 6};
  volume.spacing_mm = {2, 1, 3};
  volume.axes.col(0) = -Vector3d::UnitZ();
  volume.axes.col(1) = -Vector3d::UnitX();
  volume.axes.col(2) = Vector3d::UnitY();
  volume.origin = {4, -8, 6};
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 7; ++j)
      for (int i = 0; i < 5; ++i)
        volume.values.push_back(static_cast<std::int16_t>(value_at(volume.position(i, j, k))));
  return volume;
}

TEST(CtSlices, ShowThePatientAsRadiologistsDo) {
  const Volume volume = turned_volume();
  const Vector3d point(1, -2, 2);
  for (const SliceSide side : {SliceSide::axial, SliceSide::coronal, SliceSide::sagittal}) {
    const SliceValues slice = slice_through(volume, side, point);
    const bool axial = side == SliceSide::axial, sagittal = side == SliceSide::sagittal;
    EXPECT_GT(slice.right[sagittal ? 1 : 0], 0);
    EXPECT_GT(axial ? slice.down.y() : -slice.down.z(), 0);
    EXPECT_GT(slice.step[axial ? 2 : sagittal ? 0 : 1], 0);
    ASSERT_EQ(slice.values.size(), static_cast<std::size_t>(slice.width * slice.height));
    for (int y = 0; y < slice.height; ++y)
      for (int x = 0; x < slice.width; ++x) {
        const Vector3d p = slice.corner + x * slice.right + y * slice.down;
        EXPECT_EQ(slice.values[static_cast<std::size_t>(y * slice.width + x)],
                  std::lround(value_at(p)));
      }
    // It is the nearest one.
    EXPECT_LE(std::abs((point - slice.corner).dot(slice.step.normalized())),
              0.5 * slice.step.norm() + 1e-9);
  }
  EXPECT_EQ(slice_through(volume, SliceSide::axial, {0, 0, 1e9}).number, 4);
  EXPECT_EQ(slice_through(volume, SliceSide::axial, {0, 0, -1e9}).number, 0);
}

/// A slice with a disc: 1000 inside, falling linearly over two values at its edge.
SliceValues disc(int size, double radius, double outside, double inside) {
  SliceValues slice;
  slice.width = slice.height = size;
  const double middle = 0.5 * (size - 1);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double deep =
          std::clamp(0.5 + 0.5 * (radius - std::hypot(x - middle, y - middle)), 0.0, 1.0);
      slice.values.push_back(static_cast<std::int16_t>(outside + deep * (inside - outside)));
    }
  return slice;
}

TEST(CtSlices, AnOutlineLiesBetweenTheValues) {
  const SliceValues slice = disc(61, 20, 0, 1000);
  std::vector<float> values(slice.values.begin(), slice.values.end());
  double length = 0;
  for (const OutlinePiece& piece : outlines(values, 61, 61, 500)) {
    length += (piece[1] - piece[0]).norm();
    for (const auto& p : piece) EXPECT_NEAR(std::hypot(p.x() - 30, p.y() - 30), 20, 0.06);
  }
  // One closed line: chords of a circle are at most 1 % shorter than it.
  EXPECT_NEAR(length, 2 * std::numbers::pi * 20, 0.01 * 2 * std::numbers::pi * 20);
  EXPECT_TRUE(outlines(values, 61, 61, 1500).empty());
}

TEST(CtSlices, DiagonalNeighboursAreConnectedByTheMiddle) {
  const std::vector<float> joined = {10, 4, 4, 10}, parted = {10, -10, -10, 10};
  for (const auto& values : {joined, parted}) EXPECT_EQ(outlines(values, 2, 2, 5).size(), 2u);
  // Joined: the lines cut off the low corners; parted: the high ones.
  const auto cuts_low = [](const std::vector<float>& values) {
    const auto pieces = outlines(values, 2, 2, 5);
    return std::all_of(pieces.begin(), pieces.end(), [](const OutlinePiece& piece) {
      const Eigen::Vector2f middle = 0.5f * (piece[0] + piece[1]);
      return (middle.x() > 0.5f) != (middle.y() > 0.5f);
    });
  };
  EXPECT_TRUE(cuts_low(joined));
  EXPECT_FALSE(cuts_low(parted));
}

TEST(CtSlices, SkinIsWhatTheAirAroundMeets) {
  SliceValues slice = disc(61, 25, -1000, 50);
  for (int y = 26; y < 35; ++y)
    for (int x = 26; x < 35; ++x) slice.values[static_cast<std::size_t>(y * 61 + x)] = -1000;
  const std::vector<float> values(slice.values.begin(), slice.values.end());
  const auto all = outlines(values, 61, 61, -475), outer = outer_outlines(values, 61, 61, -475);
  EXPECT_GT(all.size(), outer.size());
  ASSERT_GT(outer.size(), 100u);
  for (const OutlinePiece& piece : outer)
    EXPECT_NEAR(std::hypot(piece[0].x() - 30, piece[0].y() - 30), 25, 0.2);
}

/// A ball of bone in soft tissue, in air.
Volume ball() {
  Volume volume;
  volume.size = {60, 60, 40};
  volume.spacing_mm = {1, 1, 1.5};
  volume.origin = {-29.5, -29.5, -29.25};
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i) {
        const double r = volume.position(i, j, k).norm();
        volume.values.push_back(r < 15 ? 1200 : r < 25 ? 50 : -1000);
      }
  return volume;
}

struct Counted {
  int yellow = 0, blue = 0;
  double farthest_yellow = 0, nearest_blue = 1e9;  // from the middle, mm
};
Counted count_lines(const CtSliceView& view) {
  Counted counted;
  const CtPixels& picture = *view.picture;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t* p = &picture.rgba[static_cast<std::size_t>(4 * (y * picture.width + x))];
      const Vector3d at = view.corner + (x + 0.5) / picture.width * view.width_mm * view.right +
                          (y + 0.5) / picture.height * view.height_mm * view.down;
      if (p[0] > 200 && p[2] < 110) {
        ++counted.yellow;
        counted.farthest_yellow = std::max(counted.farthest_yellow, at.norm());
      }
      if (p[2] > 200 && p[0] < 130) {
        ++counted.blue;
        counted.nearest_blue = std::min(counted.nearest_blue, at.norm());
      }
    }
  return counted;
}

TEST(CtSlices, PicturesShowBoneAndSkin) {
  const Volume volume = ball();
  for (const SliceSide side : {SliceSide::axial, SliceSide::coronal, SliceSide::sagittal}) {
    const CtSliceView view = draw_slice(volume, side, Vector3d::Zero(), {600, -475});
    ASSERT_TRUE(view.picture);
    EXPECT_NEAR(view.width_mm, 60, 1e-9);
    EXPECT_NEAR(view.height_mm, 60, 1e-9);
    const Counted lines = count_lines(view);
    EXPECT_GT(lines.yellow, 300);
    EXPECT_GT(lines.blue, 300);
    EXPECT_LT(lines.farthest_yellow, 16.5);
    EXPECT_GT(lines.nearest_blue, 23.5);
    // No bone above its own value.
    EXPECT_EQ(count_lines(draw_slice(volume, side, Vector3d::Zero(), {1500, -475})).yellow, 0);
  }
  const CtSliceView axial = draw_slice(volume, SliceSide::axial, Vector3d::Zero(), {600, -475});
  EXPECT_EQ(axial.sides, (std::array<std::string, 4>{"R", "L", "A", "P"}));
}

TEST(CtSlices, TheSolidIsTheBone) {
  const Volume volume = ball();
  const SolidScan scan(volume, 600, 2);
  const auto drawn = [&](double threshold, double turn, double tilt) {
    const CtPixels picture = scan.picture(100, threshold, turn, tilt, 2);
    int count = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4) count += picture.rgba[i] > 30;
    return count;
  };
  // Half the picture is half the diagonal of the box around the values of bone.
  const double half_mm = Vector3d(14.5, 14.5, 14.25).norm(), radius_pixels = 50 * 15 / half_mm;
  const double expected = std::numbers::pi * radius_pixels * radius_pixels;
  const double error = 0.05 * expected;  // the ball's steps, of a thirtieth of its radius
  for (const double turn : {0.0, 35.0, 170.0})
    EXPECT_NEAR(drawn(600, turn, 20), expected, error) << turn;
  EXPECT_NEAR(drawn(600, 0, 89), expected, error);
  EXPECT_EQ(drawn(1500, 0, 0), 0);
  // Soft tissue is larger: it fills the picture's middle and leaves it.
  EXPECT_GT(drawn(-475, 0, 0), 1.8 * expected);
}

}  // namespace
}  // namespace condyle
