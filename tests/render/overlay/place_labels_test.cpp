// Labels at places of a picture.
#include "render/overlay/place_labels.h"

#include <gtest/gtest.h>

#include <cmath>

namespace condyle {
namespace {

double width_of(const std::string& words) { return 7.0 * static_cast<double>(words.size()); }

TEST(PlaceLabels, NameTheNearSideWithoutOverlaps) {
  std::vector<PlaceLabel> labels;
  for (int i = 0; i < 8; ++i) {
    const auto z = static_cast<float>(3 * i);
    labels.push_back({"near " + std::to_string(i), {10, -30, z}});
    labels.push_back({"far " + std::to_string(i), {10, 30, z}});
  }
  const auto placed = placed_labels(labels, Camera{}, {1000, 800}, 18, width_of);
  EXPECT_GE(placed.size(), 6u);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    EXPECT_EQ(placed[i].words.rfind("near", 0), 0u) << placed[i].words;
    EXPECT_GE(placed[i].corner.x(), 0);
    EXPECT_LE(placed[i].corner.x() + placed[i].width, 1000);
    for (std::size_t k = 0; k < i; ++k) {
      const bool apart = std::abs(placed[i].corner.y() - placed[k].corner.y()) >= 18 ||
                         placed[i].corner.x() > placed[k].corner.x() + placed[k].width ||
                         placed[k].corner.x() > placed[i].corner.x() + placed[i].width;
      EXPECT_TRUE(apart) << placed[i].words << " over " << placed[k].words;
    }
  }
}

TEST(PlaceLabels, LieWhereTheCameraSeesThePlace) {
  // Straight in front of the camera: the middle of the picture; to the patient's left: right.
  const std::vector<PlaceLabel> labels = {{"middle", {0, 0, 0}}, {"left", {20, 0, 0}}};
  const auto placed = placed_labels(labels, Camera{}, {1000, 800}, 18, width_of);
  ASSERT_EQ(placed.size(), 2u);
  for (const PlacedLabel& label : placed) {
    EXPECT_NEAR(label.place.y(), 400, 0.01);
    const double mm = label.words == "left" ? 20 : 0;
    EXPECT_NEAR(label.place.x(), 500 + mm * 400 / (600 * std::tan(12 * M_PI / 180)), 0.01);
  }
}

TEST(PlaceLabels, AreDrawnWithTheirWords) {
  Image image{400, 300, std::vector<std::uint8_t>(std::size_t{400} * 300 * 4, 128)};
  const Image bare = image;
  const Glyphs words;
  ASSERT_TRUE(words.has_font()) << "install fonts-dejavu-core";
  draw_labels(image, words, Camera{}, {});
  EXPECT_EQ(image.rgba, bare.rgba);
  const std::vector<PlaceLabel> labels = {{"Masseter", {0, 0, 0}}};
  draw_labels(image, words, Camera{}, labels);
  EXPECT_NE(image.rgba, bare.rgba);
}

}  // namespace
}  // namespace condyle
