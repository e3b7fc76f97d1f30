#include "engine/collide/triangle_distance.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/engine/collide/triangle_oracle.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

constexpr double no_bound = std::numeric_limits<double>::infinity();

test::Corners widen(const Triangle& t) {
  return {t[0].cast<test::Real>(), t[1].cast<test::Real>(), t[2].cast<test::Real>()};
}

Triangle any_triangle(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> along(-size, size);
  Triangle t;
  for (auto& p : t) p = {along(random), along(random), along(random)};
  return t;
}

Triangle moved(Triangle t, const Pose& pose) {
  for (auto& p : t) p = pose * p;
  return t;
}

/// Two planes a distance d apart with a triangle beyond each: no points can be nearer.
void expect_separated_by_slab(const Triangle& a, const Triangle& b, const TriangleGap& gap) {
  const double d = std::sqrt(gap.squared_mm2);
  const Eigen::Vector3d n = (gap.q - gap.p) / d;
  EXPECT_NEAR((gap.q - gap.p).norm(), d, 1e-12);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(n.dot(a[k] - gap.p), 1e-9);
    EXPECT_GE(n.dot(b[k] - gap.q), -1e-9);
  }
}

TEST(TriangleDistance, EqualsTheOracleAndIsProvedByASlab) {
  std::mt19937_64 random(7);
  int apart = 0, crossing = 0;
  for (int i = 0; i < 20000; ++i) {
    const Triangle a = any_triangle(random, 5);
    Triangle b = any_triangle(random, 5);
    if (i % 2)
      for (auto& p : b) p.x() += 8;
    const TriangleGap gap = triangle_distance(a, b, no_bound);
    const double expected = static_cast<double>(test::triangle_distance_oracle(widen(a), widen(b)));
    ASSERT_NEAR(std::sqrt(gap.squared_mm2), expected, 1e-11);
    if (expected > 1e-6) {
      expect_separated_by_slab(a, b, gap);
      ++apart;
    } else {
      ++crossing;
    }
    ASSERT_EQ(triangle_crossing(a, b).crosses, expected == 0);
  }
  EXPECT_GT(apart, 5000);
  EXPECT_GT(crossing, 1000);
}

TEST(TriangleDistance, HoldsWhereEdgesAreParallelAndFacesCoplanar) {
  // Pieces of one lattice, turned as one: edges parallel to rounding, shared corners, faces in one
  // plane. The distance before turning is the oracle's in exact small numbers.
  std::mt19937_64 random(8);
  std::uniform_int_distribution<int> step(-2, 2);
  int apart = 0;
  for (int i = 0; i < 20000; ++i) {
    Triangle a, b;
    for (auto* t : {&a, &b})
      for (auto& p : *t)
        p = {1.0 * step(random), 1.0 * step(random), i % 3 ? 1.0 * step(random) : 0.0};
    const double expected = static_cast<double>(test::triangle_distance_oracle(widen(a), widen(b)));
    const Pose pose = test::any_pose(random, 50);
    const double found =
        std::sqrt(triangle_distance(moved(a, pose), moved(b, pose), no_bound).squared_mm2);
    if (expected < 1e-9) continue;  // touching lattices may part by a rounding error
    ASSERT_NEAR(found, expected, 1e-10) << i;
    ++apart;
  }
  EXPECT_GT(apart, 4000);
}

TEST(TriangleDistance, HoldsWhereEdgesAreNearlyParallel) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> exponent(-12, -4);
  for (int i = 0; i < 20000; ++i) {
    const Triangle a = any_triangle(random, 5);
    const double tilt = std::pow(10, exponent(random)), lift = std::pow(10, exponent(random) + 4);
    Triangle b = any_triangle(random, 5);
    // One edge of b lies along an edge of a, turned by `tilt`, `lift` beyond it.
    const Eigen::Vector3d along = (a[1] - a[0]).normalized();
    const Eigen::Vector3d side = along.unitOrthogonal(), up = along.cross(side);
    b[0] = a[0] - along + lift * up - tilt * side;
    b[1] = a[1] + along + lift * up + tilt * side;
    const double expected = static_cast<double>(test::triangle_distance_oracle(widen(a), widen(b)));
    ASSERT_NEAR(std::sqrt(triangle_distance(a, b, no_bound).squared_mm2), expected, 1e-9) << i;
  }
}

TEST(TriangleDistance, HoldsForTrianglesWithoutArea) {
  const Triangle face = {Eigen::Vector3d{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const Eigen::Vector3d p(1, 1, 3), q(9, 1, 3);
  EXPECT_EQ(triangle_distance(face, {p, p, p}, no_bound).squared_mm2, 9);
  EXPECT_EQ(triangle_distance({p, p, p}, face, no_bound).squared_mm2, 9);
  EXPECT_EQ(triangle_distance(face, {p, q, q}, no_bound).squared_mm2, 9);
  EXPECT_EQ(triangle_distance({p, p, p}, {q, q, q}, no_bound).squared_mm2, 64);
}

TEST(TriangleDistance, ABoundBelowTheAnswerEndsTheSearch) {
  std::mt19937_64 random(10);
  for (int i = 0; i < 2000; ++i) {
    const Triangle a = any_triangle(random, 3);
    Triangle b = any_triangle(random, 3);
    for (auto& p : b) p.z() += 8;
    const double exact = triangle_distance(a, b, no_bound).squared_mm2;
    EXPECT_EQ(triangle_distance(a, b, 0.5 * exact).squared_mm2, 0.5 * exact);
    EXPECT_EQ(triangle_distance(a, b, 2 * exact).squared_mm2, exact);
  }
}

TEST(TriangleOverlap, IsTheShortestMoveThatPartsThem) {
  std::mt19937_64 random(11);
  int crossing = 0;
  for (int i = 0; i < 4000; ++i) {
    const Triangle a = any_triangle(random, 4), b = any_triangle(random, 4);
    if (!triangle_crossing(a, b).crosses) continue;
    ++crossing;
    const double least = triangle_overlap(a, b);
    // No shorter move parts them, whatever its direction.
    std::normal_distribution<double> normal;
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d direction =
          Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      Triangle c = b;
      for (auto& p : c) p += 0.999 * least * direction;
      ASSERT_LE(triangle_distance(a, c, no_bound).squared_mm2, 1e-20);
    }
  }
  EXPECT_GT(crossing, 300);
}

}  // namespace
}  // namespace condyle
