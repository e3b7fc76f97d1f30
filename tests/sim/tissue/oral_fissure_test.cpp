#include "sim/tissue/oral_fissure.h"

#include <gtest/gtest.h>

#include <cmath>

namespace condyle::test {
namespace {

using Eigen::Vector3d;

/// From x = -20 to 20 at z = 0.
OralFissure straight_fissure() {
  const TriMesh skin{{{-20, 0, 0}, {20, 0, 0}, {0, 0, 0.5}, {0, 0, -0.5}}, {}, {}};
  MouthOutline mouth;
  mouth.right_corner = 0;
  mouth.left_corner = 1;
  mouth.upper = {2};
  mouth.lower = {3};
  return OralFissure(skin, mouth);
}

TEST(OralFissure, PathsLeadRoundItsCornersAtAnyDepth) {
  const OralFissure fissure = straight_fissure();
  const Vector3d above(0, 0, 3), below(0, 0, -3), deep_below(0, 8, -3);
  const double round = 2 * std::hypot(20, 3);
  EXPECT_DOUBLE_EQ(fissure.distance(above, 1, above + Vector3d(5, 0, 0), 1), 5);
  EXPECT_NEAR(fissure.distance(above, 1, below, -1), round, 1e-12);
  EXPECT_NEAR(fissure.distance(above, 1, deep_below, -1), std::hypot(round, 8), 1e-12);
  // Behind a corner both lips are as near as they look.
  const Vector3d behind(20, 8, 0), lower(12, 0, -4);
  EXPECT_NEAR(fissure.distance(behind, 1, lower, -1), (behind - lower).norm(), 0.02);
}

TEST(OralFissure, SamplesOpenWithTheSquareRootOfTheDistanceToACorner) {
  const OralFissure fissure = straight_fissure();
  const double reach = 10;
  const Vector3d corner(20, 0, 0);
  const auto sampled = [&](double distance) {
    const Vector3d p = corner + distance * Vector3d(-0.6, 0, 0.8);
    const Vector3d at = fissure.sampled_at(p, reach);
    EXPECT_LT((at - corner).cross(p - corner).norm(), 1e-9) << "on the same line from the corner";
    return (at - corner).norm();
  };
  EXPECT_EQ(sampled(0), 0);
  EXPECT_NEAR(sampled(0.001), reach * std::sqrt(0.0001), 0.001);
  EXPECT_NEAR(sampled(0.0004) / sampled(0.0001), 2, 0.01);
  EXPECT_EQ(sampled(10), 10);
  EXPECT_EQ(sampled(15), 15);
  EXPECT_NEAR((sampled(9.999) - sampled(9.99)) / 0.009, 1, 0.01) << "smooth at its reach";
  const Vector3d p(18, 0, 1);
  EXPECT_EQ(fissure.sampled_at(p, 0), p);
  EXPECT_EQ(OralFissure().sampled_at(p, reach), p);
}

}  // namespace
}  // namespace condyle::test
