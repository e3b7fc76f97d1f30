// Edges are smooth between any two parts, and shadows have soft edges without grain.
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using Edges = WithContext;

TriMesh quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
             const Eigen::Vector3d& d) {
  TriMesh mesh;
  mesh.vertices = {a, b, c, d};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST_F(Edges, AreSmoothWherePartsShareARim) {
  // A slanted line parts gums from a tooth; both lie in one plane.
  const Eigen::Vector3d low(-4, 0, -40), high(5, 0, 40);
  const std::vector<Part> parts = {
      make_part("tooth", Role::upper_teeth, quad({-40, 0, -40}, low, high, {-40, 0, 40})),
      make_part("gums", Role::upper_gums, quad(low, {40, 0, -40}, {40, 0, 40}, high))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings(200);
  settings.shadows = false;
  const auto between = [&](int samples) {
    settings.samples = samples;
    const Image image = renderer.picture(front_camera(), settings);
    int rows = 0;
    for (int y = 40; y < 160; ++y) {
      const int tooth = pixel(image, 60, y).g, gums = pixel(image, 140, y).g;
      EXPECT_GT(tooth, gums + 60);
      bool blended = false;
      for (int x = 70; x < 130; ++x) {
        const int g = pixel(image, x, y).g;
        blended |= g > gums + 12 && g < tooth - 12;
      }
      rows += blended;
    }
    return rows;
  };
  EXPECT_EQ(between(1), 0);
  EXPECT_GT(between(4), 60);
}

TEST_F(Edges, OfASliverHaveTheLightOfWhatLiesNearestBehind) {
  // Right before a tooth's edge, far before gums; it covers no pixel's middle.
  std::vector<Part> parts = {
      make_part("tooth", Role::upper_teeth,
                quad({-40, 0, -40}, {0, 0, -40}, {0, 0, 40}, {-40, 0, 40})),
      make_part("gums", Role::upper_gums,
                quad({0, 40, -45}, {45, 40, -45}, {45, 40, 45}, {0, 40, 45}))};
  auto settings = mask_settings(200);
  settings.shadows = false;
  const auto picture = [&] { return SceneRenderer(parts).picture(front_camera(), settings); };
  const Image bare = picture();
  parts.push_back(make_part("sliver", Role::skull,
                            quad({.03, -1, -40}, {.1, -1, -40}, {.1, -1, 40}, {.03, -1, 40})));
  const Image image = picture();
  const auto green = [](const Image& of, int x, int y) { return pixel(of, x, y).g; };
  for (int y = 40; y < 160; ++y)
    EXPECT_GT(green(image, 100, y),
              green(bare, 100, y) + (green(bare, 90, y) - green(bare, 100, y)) / 8)
        << y;
}

TEST_F(Edges, OfShadowsHaveNoGrain) {
  // A ball before a wall, both of bone: across its shadow's edge light grows steadily.
  const std::vector<Part> parts = {
      make_part("wall", Role::skull,
                quad({-60, 30, -60}, {60, 30, -60}, {60, 30, 60}, {-60, 30, 60})),
      make_part("ball", Role::maxilla, ball({0, 0, 0}, 14))};
  SceneRenderer renderer(parts);
  constexpr int side = 1200;  // as enlarged: a pattern of the pixels would stand out
  auto settings = mask_settings(side);
  settings.samples = 1;
  const Image lit = renderer.picture(front_camera(), settings);
  settings.shadows = false;
  const Image bare = renderer.picture(front_camera(), settings);
  const auto shade = [&](int x, int y) { return pixel(bare, x, y).g - pixel(lit, x, y).g; };
  // Second differences along rows, from one two pixels to the next, where the shadow is neither
  // full nor none.
  int deepest = 0, edge = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) deepest = std::max(deepest, shade(x, y));
  ASSERT_GT(deepest, 40);
  double grain = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 2; x + 2 < side; ++x) {
      const int s = shade(x, y);
      if (s < 0.2 * deepest || s > 0.8 * deepest) continue;
      grain += std::abs(shade(x - 2, y) - 2 * s + shade(x + 2, y));
      ++edge;
    }
  ASSERT_GT(edge, 5000);
  EXPECT_LT(grain / edge, 0.02 * deepest);
}

TEST_F(Edges, OfShadowsAreNotThrownOnLipsByWhatLiesOnThem) {
  // A strip of a lower jaw before a wall of skin, as far off as lips that have opened are from what
  // throws their shadow.
  const auto shaded = [](const Eigen::Vector3f& color, double before_mm) {
    TriMesh wall = quad({-40, 0, -40}, {40, 0, -40}, {40, 0, 40}, {-40, 0, 40});
    wall.colors.assign(wall.vertices.size(), color);
    const double y = -before_mm;
    const std::vector<Part> parts = {
        make_part("face", Role::face, wall),
        make_part("strip", Role::mandible, quad({-30, y, 0}, {30, y, 0}, {30, y, 6}, {-30, y, 6}))};
    SceneRenderer renderer(parts);
    auto settings = mask_settings(200);
    const Image lit = renderer.picture(front_camera(), settings);
    settings.shadows = false;
    const Image bare = renderer.picture(front_camera(), settings);
    int darker = 0;
    for (int y_pixel = 0; y_pixel < 200; ++y_pixel)
      for (int x = 0; x < 200; ++x)
        darker += pixel(lit, x, y_pixel).g < pixel(bare, x, y_pixel).g - 8;
    return darker;
  };
  const Eigen::Vector3f skin(.86f, .66f, .55f), lip(.74f, .43f, .40f);
  EXPECT_GT(shaded(skin, 2), 200);
  EXPECT_EQ(shaded(lip, 2), 0);
  EXPECT_GT(shaded(lip, 6), 500);
}

}  // namespace
}  // namespace condyle
