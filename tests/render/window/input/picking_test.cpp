#include "render/window/input/picking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/render/scene_parts.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Position of a point of the world in the view, pixels.
Eigen::Vector2d pixel_of(const Camera& camera, const ViewRect& view, const Vector3d& p) {
  const Eigen::Vector4f q = projection_matrix(camera, view.width / view.height, 1, 3000) *
                            view_matrix(camera) * p.cast<float>().homogeneous();
  return {view.x + view.width * (0.5 + 0.5 * q.x() / q.w()),
          view.y + view.height * (0.5 - 0.5 * q.y() / q.w())};
}

TEST(Pointing, FindsTheNearestSurfaceAndTheValueThere) {
  const TriMesh near = ball({0, 0, 0}, 20), far = ball({0, 0, 0}, 40);
  std::vector<float> heights, ones(far.vertices.size(), 1.f);
  for (const auto& v : near.vertices) heights.push_back(static_cast<float>(v.z()));
  Pose X_near;
  X_near.R = Eigen::AngleAxisd(0.3, Vector3d::UnitX());
  X_near.t = {0, -60, 10};
  const PickableSurface surfaces[] = {{&far, {}, ones}, {&near, X_near, heights}};
  const Camera camera =
      standard_camera("three-quarter", {-60, -90, -60}, {60, 60, 60}, 800.0 / 600);
  const ViewRect view{100, 50, 800, 600};
  const Vector3d eye = camera.target + camera.distance_mm * camera.direction.normalized();
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  int near_hits = 0;
  for (int i = 0; i < 200; ++i) {
    // A point on the front of the small ball, in its own coordinates.
    Vector3d q = 20 * Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Vector3d p = X_near * q;
    if ((X_near.R * q).normalized().dot((eye - p).normalized()) < 0.3) continue;
    const auto found = pick_value(camera, view, pixel_of(camera, view, p), surfaces);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->surface, 1u);
    EXPECT_NEAR(found->value, q.z(), 0.25);
    ++near_hits;
  }
  EXPECT_GT(near_hits, 40);
  EXPECT_FALSE(pick_value(camera, view, {105, 55}, surfaces).has_value());
  const auto behind = pick_value(camera, view, pixel_of(camera, view, {0, 0, -38}), surfaces);
  ASSERT_TRUE(behind.has_value());
  EXPECT_EQ(behind->surface, 0u);
  EXPECT_EQ(behind->value, 1);
}

TEST(Pointing, BesideAVertexBeyondTheRangeIsBeyond) {
  const TriMesh mesh = ball({0, 0, 0}, 20, 6);
  const std::vector<float> values(mesh.vertices.size(), std::numeric_limits<float>::infinity());
  const PickableSurface surfaces[] = {{&mesh, {}, values}};
  const auto found = pick_value(front_camera(), {0, 0, 200, 200}, {96, 93}, surfaces);
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(std::isinf(found->value));
}

}  // namespace
}  // namespace condyle
