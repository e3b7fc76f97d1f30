#include "engine/field/primitives.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/field/recipe.h"
#include "engine/field/smooth.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<Vector3d> scattered(int count, double reach) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-reach, reach);
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(at(random), at(random), at(random));
  return points;
}

double slope(const Distance& d, const Vector3d& p) {
  const double h = 1e-4;
  Vector3d g;
  for (int a = 0; a < 3; ++a)
    g[a] = (d(p + h * Vector3d::Unit(a)) - d(p - h * Vector3d::Unit(a))) / (2 * h);
  return g.norm();
}

TEST(Primitives, SphereIsItsExactDistance) {
  const auto sphere = ellipsoid({1, 2, 3}, Vector3d::Constant(4));
  int asked = 0;
  for (const auto& p : scattered(200, 10)) {
    const double r = (p - Vector3d(1, 2, 3)).norm();
    if (r < 0.3) continue;
    EXPECT_NEAR(sphere.distance(p), r - 4, 1e-12);
    ++asked;
  }
  EXPECT_GT(asked, 150);
}

TEST(Primitives, StraightTubeIsACapsule) {
  const auto capsule = tube({{-3, 0, 0}, {3, 0, 0}}, {2, 2});
  for (const auto& p : scattered(200, 8)) {
    const Vector3d on(std::clamp(p.x(), -3.0, 3.0), 0, 0);
    EXPECT_NEAR(capsule.distance(p), (p - on).norm() - 2, 1e-12);
  }
}

TEST(Primitives, RoundFlatTubeEqualsTube) {
  const std::vector<Vector3d> points{{0, 0, 0}, {4, 1, 0}, {6, 4, 2}};
  const auto round = tube(points, {2, 1.5, 1}),
             flat = flat_tube(points, {2, 1.5, 1}, {2, 1.5, 1}, {0, 0, 1});
  int outside = 0;
  for (const auto& p : scattered(400, 9)) {
    const double d = round.distance(p);
    if (d < 0) continue;
    EXPECT_NEAR(flat.distance(p), d, 1e-9);
    ++outside;
  }
  EXPECT_GT(outside, 200);
}

TEST(Primitives, RoundedBoxAgreesOnFacesAndCorner) {
  const auto box = rounded_box({0, 0, 0}, {3, 4, 5}, 1);
  EXPECT_NEAR(box.distance({3.5, 0, 0}), 0.5, 1e-12);
  EXPECT_NEAR(box.distance({0, -4.5, 0}), 0.5, 1e-12);
  EXPECT_NEAR(box.distance(Vector3d(2, 3, 4) + Vector3d(1, 1, 1)), std::sqrt(3.0) - 1, 1e-12);
  EXPECT_NEAR(box.distance({0, 0, 0}), -3, 1e-12);
}

TEST(Primitives, NearTheSurfaceTheSlopeIsThatOfADistance) {
  const std::vector<Primitive> shapes = {
      ellipsoid({0, 0, 0}, {9, 5, 4}, axis_rotation('z', 30)),
      flat_tube({{-6, 0, 0}, {0, 3, 1}, {6, 0, 2}}, {3, 2.5, 2}, {2, 2, 3}, {0, 0, 1}),
      rounded_box({0, 0, 0}, {5, 4, 3}, 1.5)};
  int asked = 0;
  for (const auto& shape : shapes)
    for (const auto& p : scattered(3000, 10)) {
      const double d = shape.distance(p);
      if (std::abs(d) > 1 || std::abs(d) < 1e-3) continue;
      const double g = slope(shape.distance, p);
      EXPECT_GT(g, 0.6) << p.transpose();
      EXPECT_LT(g, 1.45) << p.transpose();
      ++asked;
    }
  EXPECT_GT(asked, 500);
}

TEST(Primitives, BoxHoldsTheSolid) {
  const auto shape =
      ellipsoid({1, 0, 0}, {9, 2, 4}, axis_rotation('y', 40) * axis_rotation('z', 25));
  int inside = 0;
  for (const auto& p : scattered(4000, 10))
    if (shape.distance(p) < 0) {
      EXPECT_TRUE(shape.box.contains(p));
      ++inside;
    }
  EXPECT_GT(inside, 50);
}

TEST(Primitives, PolygonDistanceIsThatToTheSquare) {
  const std::vector<Vector2d> square{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
  EXPECT_NEAR(polygon_distance(square, {0, 0.5}), -1.5, 1e-12);
  EXPECT_NEAR(polygon_distance(square, {5, 6}), 5, 1e-12);
  EXPECT_NEAR(polygon_distance(square, {-3, 0}), 1, 1e-12);
}

TEST(Recipe, EqualDistancesGrowByAQuarterOfTheRounding) {
  EXPECT_NEAR(smooth_min(3, 3, 4), 2, 1e-12);
  EXPECT_NEAR(smooth_max(3, 3, 4), 4, 1e-12);
  EXPECT_EQ(smooth_min(1, 6, 4), 1);
  EXPECT_EQ(smooth_min(1, 2, 0), 1);
}

TEST(Recipe, CutAndKeepAreIntersections) {
  const auto ball = ellipsoid({0, 0, 0}, Vector3d::Constant(5)),
             bite = ellipsoid({5, 0, 0}, Vector3d::Constant(2));
  FieldRecipe cut, keep;
  cut.add(ball, 0);
  cut.cut(bite, 0);
  keep.add(ball, 0);
  keep.keep(bite, 0);
  for (const auto& p : scattered(300, 6)) {
    const double exact = std::max(ball.distance(p), -bite.distance(p));
    if (exact > -3) {  // deeper, the bite's box may replace it
      EXPECT_NEAR(cut(p), exact, 1e-12);
    } else {
      EXPECT_LT(cut(p), -2.9);
    }
    EXPECT_NEAR(keep(p), std::max(ball.distance(p), bite.distance(p)), 1e-12);
  }
}

TEST(Recipe, DistanceHasNoJumpsWherePrimitivesStopCounting) {
  FieldRecipe shape;
  shape.add(ellipsoid({0, 0, 0}, {6, 4, 3}), 0);
  shape.add(tube({{5, 0, 0}, {15, 2, 0}}, {2, 1}), 3);
  shape.cut(ellipsoid({0, 4, 0}, {2, 2, 2}), 12);  // wide: feels the others from afar
  const double step = 0.01;
  for (double y = -8; y < 8; y += 2.5)
    for (double x = -25; x < 35; x += step) {
      const double change = shape({x + step, y, 1}) - shape({x, y, 1});
      if (std::abs(shape({x, y, 1})) < 3) {
        ASSERT_LT(std::abs(change), 1.5 * step) << x << " " << y;
      }
    }
}

TEST(Recipe, MirrorSymmetryAnswersOnBothSides) {
  FieldRecipe half(Symmetry::mirror_x);
  half.add(ellipsoid({4, 1, 0}, {2, 3, 1}), 0);
  for (const auto& p : scattered(100, 6)) EXPECT_EQ(half(p), half({-p.x(), p.y(), p.z()}));
}

}  // namespace
}  // namespace condyle
