#include "engine/collide/depenetration.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/engine/collide/prisms.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

struct Body {
  CollisionMesh surface;
  Solid solid;
  explicit Body(const TriMesh& mesh) : surface(mesh), solid(mesh) {}
  operator DepenetrationBody() const { return {surface, solid}; }  // NOLINT: a body is one
};

bool overlap(const Body& a, const Pose& X_WA, const Body& b, const Pose& X_WB) {
  return touching(a.surface, X_WA, b.surface, X_WB) ||
         one_encloses_other(a.solid, X_WA, b.solid, X_WB);
}

/// The translation separates them, and except for its last hundredth they overlap. Returns its
/// length.
double expect_parts(const Body& a, const Pose& X_WA, const Body& b, const Pose& X_WB) {
  const Depenetration out = push_out(a, X_WA, b, X_WB);
  EXPECT_EQ(out.status, Depenetration::Status::found);
  EXPECT_NEAR(out.direction.norm(), 1, 1e-12);
  EXPECT_FALSE(overlap(a, X_WA, b, {X_WB.R, X_WB.t + out.length_mm * out.direction}));
  for (const double short_of : {0.011, 0.3 * out.length_mm, 0.7 * out.length_mm})
    EXPECT_TRUE(overlap(a, X_WA, b, {X_WB.R, X_WB.t + (out.length_mm - short_of) * out.direction}));
  return out.length_mm;
}

TEST(Depenetration, ABallInABallLeavesThroughTheNearestSide) {
  std::mt19937_64 random(61);
  const double R = 12, r = 5;
  const Body a(test::sphere(4, R)), b(test::sphere(3, r));
  for (const double off : {1.0, 6.0, 11.0, 16.0}) {  // wholly inside, and crossing
    const Pose X_WA = test::any_pose(random, 40);
    Pose X_WB = test::any_pose(random, 1);
    const Vector3d direction = X_WB.t.normalized();
    X_WB.t = X_WA.t + off * direction;
    const double expected = R + r - off;
    const double length = expect_parts(a, X_WA, b, X_WB);
    EXPECT_LE(length, 1.01 * expected + 0.02);
    EXPECT_GE(length, 0.98 * expected - 0.1);  // facets
    EXPECT_EQ(push_out(b, X_WB, a, X_WA).status, Depenetration::Status::found);
  }
}

TEST(Depenetration, ABoxInABoxTakesTheShortestOfSixExits) {
  std::mt19937_64 random(62);
  const Body a(test::box({-10, -8, -6}, {10, 8, 6})), b(test::box({-2, -2, -2}, {2, 2, 2}));
  for (const Vector3d& place : {Vector3d(8, 3, 1), Vector3d(1, -5, 0), Vector3d(0, 1, 2.5)}) {
    const Pose X_WA = test::any_pose(random, 40);
    const Vector3d exits = Vector3d(12, 10, 8) - place.cwiseAbs();
    const double length = expect_parts(a, X_WA, b, X_WA * Pose{Quaterniond::Identity(), place});
    EXPECT_NEAR(length, exits.minCoeff(), 0.02);
  }
}

TEST(Depenetration, ANotchIsLeftByItsMouth) {
  // Between two walls: straight up is the only short exit, each wall being 30 mm thick.
  std::mt19937_64 random(63);
  const Body block(test::prism(
      {{-34, -30}, {34, -30}, {34, 6}, {4, 6}, {4, 0}, {-4, 0}, {-4, 6}, {-34, 6}}, 60)),
      ball(test::sphere(3, 5));
  const Pose X_WA = test::any_pose(random, 40);
  const double length =
      expect_parts(block, X_WA, ball, X_WA * Pose{Quaterniond::Identity(), {0, 0, 3}});
  // Up, until it rests on the two edges, 4 mm to the sides: 6 + 3 - 3.
  EXPECT_NEAR(length, 6, 0.1);
}

TEST(Depenetration, SeparateBodiesStayAndOpenOnesAreNotMoved) {
  const Body a(test::sphere(2, 10)), b(test::sphere(2, 3));
  EXPECT_EQ(push_out(a, {}, b, {Quaterniond::Identity(), {14, 0, 0}}).status,
            Depenetration::Status::apart);
  TriMesh bowl = test::sphere(2, 10);
  bowl.triangles.pop_back();
  EXPECT_EQ(push_out(Body(bowl), {}, b, {}).status, Depenetration::Status::unknown);
}

}  // namespace
}  // namespace condyle
