#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/math/pchip.h"
#include "engine/math/pose.h"

namespace condyle::test {
namespace {

Pose random_pose(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  Pose pose;
  pose.R =
      Eigen::Quaterniond(normal(generator), normal(generator), normal(generator), normal(generator))
          .normalized();
  pose.t = 30 * Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
  return pose;
}

}  // namespace

TEST(Pose, ProductActsLikeOneAfterTheOtherAndInverseUndoes) {
  std::mt19937 generator(7);
  for (int i = 0; i < 50; ++i) {
    const Pose a = random_pose(generator), b = random_pose(generator);
    const Eigen::Vector3d p = random_pose(generator).t;
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-11);
    EXPECT_LT((a.inverse() * (a * p) - p).norm(), 1e-11);
  }
}

TEST(Pose, InterpolationStartsAndEndsRightAndMovesThePivotStraight) {
  std::mt19937 generator(8);
  const Pose a = random_pose(generator), b = random_pose(generator);
  const Eigen::Vector3d pivot(3, -40, 20);
  EXPECT_EQ(interpolate(a, b, 0, pivot).t, a.t);
  EXPECT_EQ(interpolate(a, b, 1, pivot).t, b.t);
  const Pose half = interpolate(a, b, 0.5, pivot);
  EXPECT_LT((half * pivot - 0.5 * (a * pivot + b * pivot)).norm(), 1e-11);
  EXPECT_NEAR(rotation_angle(a.inverse() * half), rotation_angle(half.inverse() * b), 1e-9);
}

TEST(Pchip, PassesThroughItsPointsAndStaysMonotone) {
  const std::vector<double> x = {0, 1, 3, 4, 7}, y = {0, 2, 2.5, 6, 6};
  const Pchip curve(x, y);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_DOUBLE_EQ(curve(x[i]), y[i]);
  for (double t = 0; t < 7; t += 0.01) EXPECT_LE(curve(t), curve(t + 0.01) + 1e-12);
  // Harmonic-mean slopes by hand: at x=1, h = 1, 2, secants 2 and 1/4.
  EXPECT_NEAR(curve.derivative(1), 9.0 / (5.0 / 2.0 + 4.0 / 0.25), 1e-12);
  EXPECT_EQ(curve(-5), 0);
  EXPECT_EQ(curve(50), 6);
  for (double t = 0.05; t < 7; t += 0.1)
    EXPECT_NEAR(curve.derivative(t), (curve(t + 1e-6) - curve(t - 1e-6)) / 2e-6, 1e-6);
}

}  // namespace condyle::test
