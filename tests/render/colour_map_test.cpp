#include "render/colour_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/contact_picture.h"
#include "render/lettering.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

float lightness(const Eigen::Vector3f& c) { return 0.3f * c.x() + 0.59f * c.y() + 0.11f * c.z(); }

TEST(ColourMap, WhiteWhereSurfacesTouchRedInsideBlueApartGreyBeyond) {
  const auto map = distance_colours();
  EXPECT_EQ(color_of(map, 0), Eigen::Vector3f::Ones());
  EXPECT_EQ(color_of(map, 0.09f), Eigen::Vector3f::Ones());
  EXPECT_EQ(color_of(map, -7), color_of(map, -2));
  EXPECT_EQ(color_of(map, std::numeric_limits<float>::infinity()), map.beyond);
  EXPECT_EQ(color_of(map, std::numeric_limits<float>::quiet_NaN()), map.beyond);
  EXPECT_EQ(color_of(map, map.high()), map.beyond);
  for (float d = 0.2f; d < 5; d += 0.1f) {
    EXPECT_GT(color_of(map, d).z(), color_of(map, d).x() + 0.1f) << d;
    EXPECT_LE(lightness(color_of(map, d + 0.1f >= 5 ? d : d + 0.1f)),
              lightness(color_of(map, d)) + 1e-6f)
        << d;
  }
  for (float d = -0.2f; d > -2; d -= 0.1f)
    EXPECT_GT(color_of(map, d).x(), color_of(map, d).z() + 0.1f) << d;
}

class Mapped : public WithContext {};

TEST_F(Mapped, PartShowsItsValuesAndBecomesItselfAgain) {
  const std::vector<Part> parts = {make_part("ball", Role::skull, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  renderer.update({});
  const auto map = distance_colours();
  renderer.set_colour_map(map);
  const auto settings = mask_settings();
  const Image plain = renderer.picture(front_camera(), settings);
  // The value rises with height: overlap below, far above.
  std::vector<float> values;
  for (const auto& v : parts[0].mesh.vertices) values.push_back(static_cast<float>(v.z()) / 5);
  renderer.color_part("ball", values);
  const Image image = renderer.picture(front_camera(), settings);
  int looked = 0;
  for (int y = 50; y < 150; y += 5) {
    const double height = (100 - (y + 0.5)) * 0.5;  // mm; the ball bulges toward the eye a little
    const float value = static_cast<float>(height) / 5;
    if (std::abs(value) < 0.3f || value > 4.5f) continue;
    const auto p = pixel(image, 100, y);
    const auto expected = color_of(map, value);
    // Shaded a little: the hue stays.
    EXPECT_EQ(p.r > p.b, expected.x() > expected.z()) << value;
    EXPECT_LE(p.r, 255 * expected.x() + 14) << value;
    EXPECT_GE(p.r, 0.6f * 255 * expected.x() - 14) << value;
    ++looked;
  }
  EXPECT_GT(looked, 12);
  const auto top = pixel(image, 100, 43);  // value above 5
  EXPECT_NEAR(top.r, top.b, 3);
  renderer.color_part("ball", {});
  EXPECT_EQ(renderer.picture(front_camera(), settings).rgba, plain.rgba);
}

TEST_F(Mapped, NearPlaneCutsAwayWhatHidesThePlace) {
  const std::vector<Part> parts = {make_part("near", Role::skull, ball({0, -60, 0}, 10)),
                                   make_part("place", Role::skull, ball({0, 0, 0}, 5))};
  SceneRenderer renderer(parts);
  renderer.update({});
  auto camera = front_camera();
  const double hidden = blob_of(renderer.picture(camera, mask_settings())).area;
  camera.near_mm = 480;
  const double seen = blob_of(renderer.picture(camera, mask_settings())).area;
  EXPECT_LT(seen, 0.5 * hidden);
  EXPECT_NEAR(seen, M_PI * 10 * 10, 15);  // two pixels a millimetre
}

TEST_F(Mapped, ContactPictureShowsBothSidesAndItsLegend) {
  const std::vector<Part> parts = {make_part("fixed", Role::skull, ball({0, 0, 20}, 20)),
                                   make_part("moved", Role::mandible, ball({0, 0, -21}, 20))};
  std::vector<float> inside(parts[0].mesh.vertices.size(), -1.5f),
      apart(parts[1].mesh.vertices.size(), 1.5f);
  const auto map = distance_colours();
  const ContactPlace place{.parts = parts,
                           .fixed = "fixed",
                           .moved = "moved",
                           .fixed_values = inside,
                           .moved_values = apart,
                           .X_CM = {},
                           .place = {0, 0, 0},
                           .middle = {0, 0, 0},
                           .normal = {0, 0, -1},
                           .seen_mm = 45,
                           .overview = "front",
                           .title = "fixed and moved",
                           .lines = {"touching"}};
  const Image image = contact_picture(place, map);
  ASSERT_EQ(image.width, 1600);
  // Beside the ring in the middle of the second and the third panel.
  const auto fixed = pixel(image, 24 + 464 + 250, 340), moved = pixel(image, 24 + 928 + 250, 340);
  EXPECT_GT(fixed.r, fixed.b + 60);
  EXPECT_GT(moved.b, moved.r + 30);
  // The bar of the legend runs through the same colours.
  int red = 0, white = 0, blue = 0;
  for (int y = 140; y < 510; ++y) {
    const auto p = pixel(image, 1432, y);
    red += p.r > p.b + 40;
    blue += p.b > p.r + 40;
    white += p.r > 250 && p.g > 250 && p.b > 250;
  }
  EXPECT_NEAR(red, 370 * 2 / 7.0, 20);
  EXPECT_NEAR(blue, 370 * 5 / 7.0, 60);
  EXPECT_GT(white, 3);
  EXPECT_EQ(contact_picture(place, map).rgba, image.rgba);
}

TEST(Lettering, WritesInsideItsWidthAndMissesNothing) {
  const Lettering words;
  ASSERT_TRUE(words.has_font()) << "install fonts-dejavu-core";
  Image image{200, 60, std::vector<std::uint8_t>(200 * 60 * 4, 255)};
  const std::string text = "2.5 mm\u00b2 \u22121";
  const double width = words.width(text, 24);
  EXPECT_GT(width, 60);
  words.write(image, 10, 40, 24, text);
  int dark = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (pixel(image, x, y).r < 128) {
        ++dark;
        EXPECT_GE(x, 9);
        EXPECT_LE(x, 11 + width);
      }
  EXPECT_GT(dark, 150);
  words.write(image, 190, 5, 40, "cut off at the edge \xff");  // and a damaged letter
}

}  // namespace
}  // namespace condyle
