#include "render/image/colour_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "engine/mesh/refine.h"
#include "render/image/glyphs.h"
#include "render/output/contact_picture.h"
#include "render/overlay/legend.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

float lightness(const Eigen::Vector3f& c) { return 0.3f * c.x() + 0.59f * c.y() + 0.11f * c.z(); }

TEST(ColourMap, WhiteWhereSurfacesTouchRedInsideBlueApartGreyBeyond) {
  for (const DistanceBands bands :
       {DistanceBands{}, DistanceBands{.near_mm = 5, .deepest_mm = 2}}) {
    const auto map = distance_colours(bands);
    const auto near = static_cast<float>(bands.near_mm),
               deepest = static_cast<float>(bands.deepest_mm);
    EXPECT_EQ(map.low(), -deepest);
    EXPECT_EQ(map.high(), near);
    EXPECT_EQ(color_of(map, 0), Eigen::Vector3f::Ones());
    EXPECT_EQ(color_of(map, 0.09f), Eigen::Vector3f::Ones());
    EXPECT_EQ(color_of(map, -7), color_of(map, -deepest));
    EXPECT_EQ(color_of(map, std::numeric_limits<float>::infinity()), map.beyond);
    EXPECT_EQ(color_of(map, std::numeric_limits<float>::quiet_NaN()), map.beyond);
    EXPECT_EQ(color_of(map, near), map.beyond);
    // The darkest blue is beside the contact, the darkest red the deepest.
    for (float d = 0.2f; d + 0.1f < near; d += 0.1f) {
      EXPECT_GT(color_of(map, d).z(), color_of(map, d).x() + 0.1f) << d;
      EXPECT_GE(lightness(color_of(map, d + 0.1f)), lightness(color_of(map, d)) - 1e-6f) << d;
    }
    for (float d = -0.2f; d - 0.1f > -deepest; d -= 0.1f) {
      EXPECT_GT(color_of(map, d).x(), color_of(map, d).z() + 0.1f) << d;
      EXPECT_LE(lightness(color_of(map, d - 0.1f)), lightness(color_of(map, d)) + 1e-6f) << d;
    }
    for (const float tick : map.ticks) EXPECT_TRUE(tick >= map.low() && tick <= map.high() + 1e-4f);
    ASSERT_GE(map.ticks.size(), 7u);
    for (std::size_t i = 1; i < map.bands.size(); ++i)
      EXPECT_EQ(map.bands[i].from, map.bands[i - 1].to);
    EXPECT_EQ(map.bands.size(), 4u);
  }
}

/// CIE L*a*b* of linear RGB.
Eigen::Vector3f lab_of(const Eigen::Vector3f& linear) {
  const Eigen::Matrix3f to_xyz{
      {0.4124f, 0.3576f, 0.1805f}, {0.2126f, 0.7152f, 0.0722f}, {0.0193f, 0.1192f, 0.9505f}};
  const Eigen::Vector3f xyz =
      (to_xyz * linear).cwiseQuotient(Eigen::Vector3f(0.9505f, 1, 1.089f)).cwiseMax(0.f);
  const auto f = [](float t) { return t > 0.008856f ? std::cbrt(t) : 7.787f * t + 16.f / 116; };
  return {116 * f(xyz.y()) - 16, 500 * (f(xyz.x()) - f(xyz.y())), 200 * (f(xyz.y()) - f(xyz.z()))};
}

struct Sight {
  const char* name;
  Eigen::Matrix3f matrix;  // linear RGB as it is seen
};
/// source: Machado, Oliveira and Fernandes 2009, severity 1
std::vector<Sight> sights() {
  return {{"normal", Eigen::Matrix3f::Identity()},
          {"protanopia", Eigen::Matrix3f{{0.152286f, 1.052583f, -0.204868f},
                                         {0.114503f, 0.786281f, 0.099216f},
                                         {-0.003882f, -0.048116f, 1.051998f}}},
          {"deuteranopia", Eigen::Matrix3f{{0.367322f, 0.860646f, -0.227968f},
                                           {0.280085f, 0.672501f, 0.047413f},
                                           {-0.011820f, 0.042940f, 0.968881f}}},
          {"tritanopia", Eigen::Matrix3f{{1.255528f, -0.076749f, -0.178779f},
                                         {-0.078411f, 0.930809f, 0.147602f},
                                         {0.004733f, 0.691367f, 0.303900f}}}};
}

Eigen::Vector3f lab_as_seen(const Eigen::Vector3f& color, const Eigen::Matrix3f& sight) {
  const Eigen::Vector3f linear = color.unaryExpr(
      [](float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); });
  return lab_of((sight * linear).cwiseMax(0.f).cwiseMin(1.f));
}

TEST(ColourMap, DisplacementsBeyondTheRangeHaveNoPositionOnTheScale) {
  const auto map = displacement_colours(75);
  EXPECT_EQ(color_of(map, 75), map.beyond);
  float least = 1000;
  for (const auto& [name, sight] : sights())
    for (float mm = 0; mm < 75; mm += 0.5f) {
      const float difference =
          (lab_as_seen(color_of(map, mm), sight) - lab_as_seen(map.beyond, sight)).norm();
      least = std::min(least, difference);
      EXPECT_GT(difference, 25) << name << ": " << mm << " mm";
    }
  EXPECT_LT(least, 100);  // they were compared
}

TEST(ColourMap, BandsStayApartWithEveryKindOfColourVision) {
  constexpr float apart = 14;  // a difference of 2 to 3 is just seen, 10 at a glance
  const auto map = distance_colours();
  const std::vector<std::vector<float>> bands = {
      {-1, -0.7f, -0.4f, -0.2f}, {0}, {0.2f, 0.35f, 0.5f}, {0.6f, 1.2f, 1.9f}, {3}};
  float least = 1000;
  for (const auto& [name, matrix] : sights()) {
    const auto seen = [&, &sight = matrix](float value) {
      return lab_as_seen(color_of(map, value), sight);
    };
    for (std::size_t i = 0; i < bands.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        for (const float p : bands[i])
          for (const float q : bands[k]) {
            const float difference = (seen(p) - seen(q)).norm();
            least = std::min(least, difference);
            EXPECT_GT(difference, apart) << name << ": " << p << " mm and " << q << " mm";
          }
  }
  EXPECT_LT(least, 60);  // they were compared
}

TEST(Legend, IsReadableInTheCornerAtEverySize) {
  const Glyphs words;
  ASSERT_TRUE(words.has_font()) << "install fonts-dejavu-core";
  const auto map = distance_colours();
  for (const auto& [width, height] :
       {std::pair{640, 360}, {1280, 720}, {720, 1280}, {3840, 2160}}) {
    Image image{width, height,
                std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 4, 128)};
    add_legend(image, words, map, {"a remark"});
    int right = 0, top = height, red = 0, white = 0, blue = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto p = pixel(image, x, y);
        if (p.r == 128 && p.g == 128 && p.b == 128) continue;
        right = std::max(right, x);
        top = std::min(top, y);
        red += p.r > p.b + 60;
        blue += p.b > p.r + 40;
        white += p.r > 250 && p.g > 250 && p.b > 250;
      }
    EXPECT_LT(right, width / 2);
    EXPECT_GT(right, width / 12);
    EXPECT_GT(top, height / 4);
    EXPECT_GT(height - top, std::min(height, width * 9 / 16) / 3);
    EXPECT_NEAR(static_cast<double>(blue) / red, 1.85 / 0.87, 0.35) << width;
    EXPECT_GT(white, red / 30);
  }
}

class Mapped : public WithContext {};

TEST_F(Mapped, PartShowsItsValuesAndBecomesItselfAgain) {
  const std::vector<Part> parts = {make_part("ball", Role::skull, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  renderer.update({});
  const auto map = distance_colours({.near_mm = 5, .deepest_mm = 2});
  renderer.set_colour_map(map);
  const auto settings = mask_settings();
  const Image plain = renderer.picture(front_camera(), settings);
  // The value rises with height: overlap below, far above.
  std::vector<float> values;
  for (const auto& v : parts[0].mesh.vertices) values.push_back(static_cast<float>(v.z()) / 5);
  renderer.color_part("ball", values);
  const Image image = renderer.picture(front_camera(), settings);
  int checked = 0;
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
    ++checked;
  }
  EXPECT_GT(checked, 12);
  const auto top = pixel(image, 100, 43);  // value above 5
  EXPECT_NEAR(top.r, top.b, 14);
  renderer.color_part("ball", {});
  EXPECT_TRUE(test::same_bytes(renderer.picture(front_camera(), settings), plain));
}

TEST_F(Mapped, TheFinerSurfaceCoincidesAndIsUsedOnlyWhileMapped) {
  const std::vector<Part> parts = {make_part("ball", Role::skull, ball({0, 0, 0}, 30, 12))};
  SceneRenderer renderer(parts);
  renderer.update({});
  const auto settings = mask_settings();
  const Image plain = renderer.picture(front_camera(), settings);
  const TriMesh& mesh = parts[0].mesh;
  const TriMesh finer = refine(mesh, std::vector<double>(mesh.vertices.size(), 2.0));
  ASSERT_GT(finer.vertices.size(), 4 * mesh.vertices.size());
  std::vector<Eigen::Vector3f> normals;
  for (const auto& v : finer.vertices) normals.push_back(v.normalized().cast<float>());
  renderer.set_finer("ball", finer, normals);
  EXPECT_TRUE(test::same_bytes(renderer.picture(front_camera(), settings), plain));
  renderer.set_colour_map(distance_colours());
  renderer.color_part("ball", std::vector<float>(finer.vertices.size(), 0.f));
  const Image mapped = renderer.picture(front_camera(), settings);
  EXPECT_NEAR(blob_of(mapped).area, blob_of(plain).area, 1e-3 * blob_of(plain).area);
  const auto middle = pixel(mapped, 100, 100);
  EXPECT_GT(middle.r, 230);
  EXPECT_GT(middle.b, 230);
  renderer.color_part("ball", {});
  EXPECT_TRUE(test::same_bytes(renderer.picture(front_camera(), settings), plain));
}

TEST_F(Mapped, NearPlaneCutsAwayOccluders) {
  const std::vector<Part> parts = {make_part("near", Role::skull, ball({0, -60, 0}, 10)),
                                   make_part("place", Role::skull, ball({0, 0, 0}, 5))};
  SceneRenderer renderer(parts);
  renderer.update({});
  auto camera = front_camera();
  const double hidden = blob_of(renderer.picture(camera, mask_settings())).area;
  camera.near_mm = 480;
  const double seen = blob_of(renderer.picture(camera, mask_settings())).area;
  EXPECT_LT(seen, 0.5 * hidden);
  EXPECT_NEAR(seen, std::numbers::pi * 10 * 10, 15);  // two pixels a millimetre
}

TEST_F(Mapped, ContactPictureShowsBothSidesAndItsLegend) {
  const std::vector<Part> parts = {make_part("fixed", Role::skull, ball({0, 0, 20}, 20)),
                                   make_part("moved", Role::mandible, ball({0, 0, -21}, 20))};
  std::vector<float> inside(parts[0].mesh.vertices.size(), -1.5f),
      apart(parts[1].mesh.vertices.size(), 1.5f);
  const auto map = distance_colours({.near_mm = 5, .deepest_mm = 2});
  const ContactView place{.parts = parts,
                          .fixed = "fixed",
                          .moved = "moved",
                          .fixed_values = inside,
                          .moved_values = apart,
                          .at = {},
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
  EXPECT_TRUE(test::same_bytes(contact_picture(place, map), image));
}

TEST(Glyphs, WritesInsideItsWidthAndMissesNothing) {
  const Glyphs words;
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

TEST(Glyphs, BreaksLinesBetweenWords) {
  const Glyphs words;
  const std::string text = "contact 238.0 mm\u00b2 in 21 patches, left upper back teeth";
  const auto lines = words.lines(text, 20, 180);
  EXPECT_GT(lines.size(), 2);
  std::string joined;
  for (const auto& line : lines) {
    EXPECT_LE(words.width(line, 20), 180);
    joined += (joined.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(joined, text);
  EXPECT_EQ(words.lines(text, 20, 2000).size(), 1);
  EXPECT_EQ(words.lines("unbreakable", 20, 5), std::vector<std::string>{"unbreakable"});
}

}  // namespace
}  // namespace condyle
