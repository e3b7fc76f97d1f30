#include "render/overlay/annotations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/image/raster_2d.h"
#include "tests/support/picture.h"

namespace condyle {
namespace {

Camera seen(const Eigen::Vector3d& direction, const Eigen::Vector3d& up = {0, 0, 1}) {
  Camera camera;
  camera.direction = direction;
  camera.up = up;
  return camera;
}

TEST(Annotations, LettersMarkThePatientsSides) {
  // As one faces the patient: his right on the left.
  const EdgeLetters front = edge_letters(seen({0, -1, 0}));
  EXPECT_EQ(front.left, 'R');
  EXPECT_EQ(front.right, 'L');
  EXPECT_EQ(front.top, 'S');
  EXPECT_EQ(front.bottom, 'I');
  const EdgeLetters left = edge_letters(seen({1, 0, 0}));
  EXPECT_EQ(left.left, 'A');
  EXPECT_EQ(left.right, 'P');
  const EdgeLetters above = edge_letters(seen({0, 0, 1}, {0, -1, 0}));
  EXPECT_EQ(above.top, 'A');
  const auto axes = axis_letters(seen({0, -1, 0}));
  EXPECT_EQ(axes.front().letter, 'P');  // the farthest first
  EXPECT_EQ(axes.back().letter, 'A');
  for (const auto& axis : axes) {
    if (axis.letter == 'S') {
      EXPECT_NEAR(axis.direction.y(), 1, 1e-6);
    }
  }
}

TEST(Annotations, TheBarIsARoundLengthOfTheSizeThatItSays) {
  Camera camera;
  for (const double away : {60.0, 200.0, 600.0, 1500.0}) {
    camera.distance_mm = away;
    const ScaleBar bar = scale_bar(camera, 1080, 1920);
    // Height of the picture at the target.
    const double height_mm = 2 * away * std::tan(camera.field_of_view_deg * std::numbers::pi / 360);
    EXPECT_NEAR(bar.pixels, bar.length_mm / height_mm * 1080, 1e-6);
    EXPECT_LE(bar.pixels, 0.18 * 1920);
    EXPECT_GE(bar.pixels, 0.18 * 1920 / 2.5 - 1e-9);
    const double digit = bar.length_mm / std::pow(10, std::floor(std::log10(bar.length_mm) + 1e-9));
    EXPECT_TRUE(std::abs(digit - 1) < 1e-9 || std::abs(digit - 2) < 1e-9 ||
                std::abs(digit - 5) < 1e-9)
        << bar.text;
  }
}

TEST(Annotations, OnATransparentPictureLeaveNoBoxBehind) {
  Image image{640, 360, std::vector<std::uint8_t>(std::size_t{4} * 640 * 360, 0)};
  const Glyphs words;
  ASSERT_TRUE(words.has_font()) << "install fonts-dejavu-core";
  words.write(image, 100, 200, 60, "I", Eigen::Vector3f::Constant(0.96f));
  int solid = 0, partly = 0, empty = 0;
  for (int y = 150; y < 205; ++y)
    for (int x = 100; x < 118; ++x) {
      const auto* p = &image.rgba[4 * (std::size_t{640} * y + x)];
      solid += p[3] == 255;
      partly += p[3] > 0 && p[3] < 255;
      empty += p[3] == 0;
      if (p[3] > 0) {
        EXPECT_NEAR(p[0], 245, 1) << "the letter's own colour, however thin";
      }
    }
  EXPECT_GT(solid, 100);
  EXPECT_GT(partly, 20);
  EXPECT_GT(empty, 100);
  // Blended over existing pixels, coverage accumulates.
  std::uint8_t pixel[4] = {0, 0, 0, 0};
  lay_over(pixel, Eigen::Vector3f::Ones(), 0.5f);
  lay_over(pixel, Eigen::Vector3f::Zero(), 0.5f);
  EXPECT_NEAR(pixel[3], 191, 1);
  EXPECT_NEAR(pixel[0], 85, 1);  // a quarter of white under half of black
}

TEST(Annotations, AreDrawnAtTheirPositionsOnlyWhenEnabled) {
  Image image{640, 360, std::vector<std::uint8_t>(std::size_t{4} * 640 * 360, 90)};
  const Image before = image;
  const Glyphs words;
  const Camera camera = seen({0, -1, 0});
  annotate(image, words, camera, {});
  EXPECT_TRUE(test::same_bytes(image, before));
  annotate(image, words, camera, {.scale_bar = true});
  const auto differs = [&](int x0, int y0, int x1, int y1) {
    int count = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const std::size_t i = 4 * (std::size_t{640} * y + x);
        count += image.rgba[i] != before.rgba[i];
      }
    return count;
  };
  EXPECT_GT(differs(440, 300, 640, 360), 40);
  EXPECT_EQ(differs(0, 0, 440, 300), 0);
  ASSERT_TRUE(words.has_font()) << "install fonts-dejavu-core";
  annotate(image, words, camera, {.letters = true, .caption = {"Opening 31.0 mm"}});
  EXPECT_GT(differs(0, 140, 60, 220), 20);      // R
  EXPECT_GT(differs(220, 300, 420, 345), 100);  // the caption
  // A line from top to bottom does not cross any text; and where axes end there is none.
  image = before;
  annotate(image, words, camera,
           {.letters = true, .line_at = 0.5, .caption = {"Opening 31.0 mm", "opening"}});
  EXPECT_EQ(differs(318, 0, 322, 360), 0);
  EXPECT_GT(differs(322, 290, 540, 345), 100);
  EXPECT_GT(differs(580, 0, 640, 50), 40);  // S and L
  EXPECT_EQ(differs(540, 0, 576, 100), 0);  // no R
}

TEST(Annotations, TheCrossHasABorderOnALightBackdrop) {
  const auto dark_rows = [](Backdrop backdrop) {
    Image image{640, 360, std::vector<std::uint8_t>(std::size_t{4} * 640 * 360, 230)};
    annotate(image, Glyphs(), seen({0, -1, 0}), {.letters = true, .backdrop = backdrop});
    int dark = 0, orange = 0;
    for (int y = 40; y < 70; ++y) {  // across the line to the patient's left
      const auto* p = &image.rgba[4 * (std::size_t{640} * y + 600)];
      dark += p[0] < 130;
      orange += p[0] > 200 && p[2] < 60;
    }
    EXPECT_GE(orange, 1);
    return dark;
  };
  EXPECT_GE(dark_rows(Backdrop::light), 2);
  EXPECT_EQ(dark_rows(Backdrop::dark), 0);
}

}  // namespace
}  // namespace condyle
