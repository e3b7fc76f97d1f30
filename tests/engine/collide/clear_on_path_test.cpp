#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "engine/collide/collision_mesh.h"
#include "engine/core/units.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The path on which a pivot moves straight while the body rotates about it.
BodyPath distance_between(const Pose& from, const Pose& to, const Vector3d& pivot) {
  const Eigen::AngleAxisd turn(from.R.conjugate() * to.R);
  return {.pivot = pivot,
          .shift = to.R.conjugate() * (to * pivot - from * pivot),
          .turn = turn.angle() * turn.axis()};
}

/// A box of small boxes, 2 mm long: its parts have different paths.
TriMesh rod(const Vector3d& low, const Vector3d& high) {
  TriMesh rod;
  for (double x = low.x(); x < high.x(); x += 2)
    rod = test::joined(rod, test::box({x, low.y(), low.z()}, {x + 2, high.y(), high.z()}));
  return rod;
}

TEST(ClearOnPath, ABodyReportedClearKeptItsDistanceOnTheWholePath) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  const CollisionMesh stays(test::sphere(2, 20, {0, 0, 0}, 0.05));
  const CollisionMesh moves(rod({-30, -4, -4}, {30, 4, 4}));
  const auto direction = [&] { return Vector3d(any(random), any(random), any(random)); };
  int clear = 0, met = 0, clear_by_parts = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Pose from = test::any_pose(random, 40);
    const Eigen::AngleAxisd turn(0.3 * any(random), direction().normalized());
    const Pose to{from.R * turn, from.t + 4 * direction()};
    const Vector3d pivot = 20 * direction();
    const double min_distance = trial % 3;
    double least = distance(stays, {}, moves, to).distance_mm;
    const double at_end = least;
    if (at_end == 0) continue;
    const BodyPath path = distance_between(from, to, pivot);
    const bool reported = clear_on_path(stays, {}, moves, to, path, min_distance);
    for (int k = 0; k < 25; ++k)
      least = std::min(
          least, distance(stays, {}, moves, interpolate(from, to, k / 25.0, pivot)).distance_mm);
    if (reported) {
      EXPECT_GE(least, min_distance) << trial;
    }
    ++(reported ? clear : met);
    double longest = 0;
    for (const Vector3d& p : test::box({-30, -4, -4}, {30, 4, 4}).vertices)
      longest = std::max(longest, path.length(p));
    clear_by_parts += reported && at_end < longest + min_distance;
  }
  EXPECT_GT(clear, 100);
  EXPECT_GT(met, 50);
  EXPECT_GT(clear_by_parts, 20);  // more than the longest path of any part would prove
}

TEST(ClearOnPath, ABodyTurningOnTheSpotMayBeNearWhileItsFarEndSwings) {
  // A lever rotates about its short end, 1 mm from a wall; its long end swings 10 mm.
  const CollisionMesh wall(test::box({-5, -50, -50}, {-3, 50, 50}));
  const CollisionMesh lever(rod({-2, -2, -2}, {100, 2, 2}));
  const Pose to;
  const Pose from{Eigen::Quaterniond(Eigen::AngleAxisd(6 * degree, Vector3d::UnitY())),
                  Vector3d::Zero()};
  const BodyPath path = distance_between(from, to, {0, 0, 0});
  EXPECT_GT(path.length({100, 0, 0}), 10);
  EXPECT_TRUE(clear_on_path(wall, {}, lever, to, path, 0));
  EXPECT_TRUE(clear_on_path(wall, {}, lever, to, path, 0.5));
  EXPECT_FALSE(clear_on_path(wall, {}, lever, to, path, 1.001));
  // The same with a distant pivot, as a jaw's condyles: rotation and translation cancel there.
  const Vector3d middle(60, 0, 0);
  const Pose half{Eigen::Quaterniond(Eigen::AngleAxisd(3 * degree, Vector3d::UnitY())),
                  Vector3d::Zero()};
  EXPECT_TRUE(clear_on_path(wall, {}, lever, to, distance_between(half, to, middle), 0.3));
  // A wall beside the long end was passed through.
  const CollisionMesh beside(test::box({80, -50, 4}, {90, 50, 5}));
  EXPECT_GT(distance(beside, {}, lever, to).distance_mm, 1.9);
  EXPECT_FALSE(clear_on_path(beside, {}, lever, to, path, 0));
}

TEST(ClearOnPath, AnyStartGivesTheSameAnswer) {
  std::mt19937_64 random(5);
  const CollisionMesh stays(test::sphere(2, 20, {0, 0, 0}, 0.05));
  const CollisionMesh moves(test::sphere(2, 10, {0, 0, 0}, 0.05));
  int clear = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Pose to{Eigen::Quaterniond::Identity(), {30.0 + 0.08 * trial, 0, 0}};
    const BodyPath path{.shift = {2, 0, 0}, .turn = {0, 0, 0.05}};
    const bool cold = clear_on_path(stays, {}, moves, to, path, 0);
    const TrianglePair near = distance(stays, {}, moves, to).triangles;
    EXPECT_EQ(clear_on_path(stays, {}, moves, to, path, 0, near), cold);
    clear += cold;
  }
  EXPECT_GT(clear, 10);
  EXPECT_LT(clear, 90);
}

}  // namespace
}  // namespace condyle
