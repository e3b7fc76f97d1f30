#include "render/scene/edge_pixels.h"

#include <algorithm>
#include <random>

#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

TEST(EdgePixels, OmitOnlyTrianglesThatCoverNoMarkedPixel) {
  constexpr int width = 60, height = 40, count = 400;
  const DrawnBox box = {7, 5, 51, 33};
  std::mt19937 random(5);
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() / 4294967296.0);
  };
  EdgePixels edges;
  const auto marks = edges.marks_within(box);
  const auto marked = [&](int x, int y) -> std::uint8_t& {
    return marks[static_cast<std::size_t>((y - box.y0) * box.width() + x - box.x0)];
  };
  for (int k = 0; k < 60; ++k)
    marked(static_cast<int>(uniform(7, 51)), static_cast<int>(uniform(5, 33))) = 255;
  // Small triangles, some of them outside of the box and of the picture, given in pixels.
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3i> triangles;
  for (int t = 0; t < count; ++t) {
    const Eigen::Vector3f middle(uniform(-9, 69), uniform(-9, 49), 0);
    for (int c = 0; c < 3; ++c)
      points.push_back(middle + Eigen::Vector3f(uniform(-2, 2), uniform(-2, 2), 0));
    triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
  }
  Eigen::Matrix4f to_clip = Eigen::Matrix4f::Identity();
  to_clip.diagonal() << 2.f / width, 2.f / height, 1, 1;
  to_clip.topRightCorner<3, 1>() << -1, -1, 0;
  const auto chosen = edges.touching(points, triangles, to_clip, width, height);
  EXPECT_LT(chosen.size(), count / 2);
  int covering = 0;
  for (const auto& t : triangles) {
    const auto corner = [&](int c) -> Eigen::Vector2f {
      return points[static_cast<std::size_t>(t[c])].head<2>();
    };
    const auto side = [&](int c, const Eigen::Vector2f& p) {
      const Eigen::Vector2f along = corner((c + 1) % 3) - corner(c), to = p - corner(c);
      return along.x() * to.y() - along.y() * to.x();
    };
    bool covers = false;
    constexpr int fine = 8;  // points per pixel and side
    for (int y = fine * box.y0; y < fine * box.y1; ++y)
      for (int x = fine * box.x0; x < fine * box.x1; ++x) {
        if (!marked(x / fine, y / fine)) continue;
        const Eigen::Vector2f p((static_cast<float>(x) + 0.5f) / fine,
                                (static_cast<float>(y) + 0.5f) / fine);
        const float a = side(0, p), b = side(1, p), c = side(2, p);
        covers |= (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
      }
    if (!covers) continue;
    ++covering;
    EXPECT_NE(std::find(chosen.begin(), chosen.end(), t), chosen.end()) << t.transpose();
  }
  EXPECT_GT(covering, 20);
}

TEST(EdgePixels, KeepTrianglesThatReachBehindTheEye) {
  EdgePixels edges;
  edges.marks_within({0, 0, 40, 40});  // none is marked
  const std::vector<Eigen::Vector3f> points = {{0, 0, -5}, {1, 0, -5}, {0, 1, -5},
                                               {0, 0, 5},  {1, 0, 5},  {0, 1, -5}};
  const std::vector<Eigen::Vector3i> triangles = {{0, 1, 2}, {3, 4, 5}};
  const Eigen::Matrix4f to_clip = projection_matrix(front_camera(), 1, 1, 100);
  const auto chosen = edges.touching(points, triangles, to_clip, 40, 40);
  ASSERT_EQ(chosen.size(), 1u);
  EXPECT_EQ(chosen[0], triangles[1]);
}

using SampledEdges = WithContext;

TEST_F(SampledEdges, LeaveThePixelsWithinASurfaceAsOneSampleDrawsThem) {
  const std::vector<Part> parts = {make_part("left", Role::skull, ball({-14, 0, 0}, 22, 40)),
                                   make_part("right", Role::maxilla, ball({14, 9, 0}, 22, 40))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings(400);
  const Image sampled = renderer.picture(front_camera(), settings);
  settings.samples = 1;
  const Image plain = renderer.picture(front_camera(), settings);
  const auto same = [&](int x, int y) {
    const auto a = pixel(sampled, x, y), b = pixel(plain, x, y);
    return a.r == b.r && a.g == b.g && a.b == b.b && a.a == b.a;
  };
  int within = 0, edges = 0;
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 400; ++x) {
      // The left ball lies before the right one: a disc about its middle shows it alone.
      const double across = std::hypot(x + 0.5 - 200 + 14 * 400 / 100.0, y + 0.5 - 200);
      if (across < 70) {
        ++within;
        EXPECT_TRUE(same(x, y)) << x << ", " << y;
      }
      edges += !same(x, y);
    }
  EXPECT_GT(within, 10000);
  EXPECT_GT(edges, 200);
}

}  // namespace
}  // namespace condyle
