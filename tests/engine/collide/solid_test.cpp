#include "engine/collide/solid.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/collide/collision_mesh.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

/// The definition, over every vertex.
double deepest_by_force(const TriMesh& points, const TriMesh& solid, const Pose& X) {
  const TriangleTree tree(solid);
  double deepest = 0;
  for (const auto& p : points.vertices) deepest = std::max(deepest, -tree.signed_distance(X * p));
  return deepest;
}

TEST(OverlapDepth, EqualsTheDefinitionOverAllVertices) {
  std::mt19937_64 random(20);
  const TriMesh mesh_a = test::sphere(3, 15, {2, 1, 0}, 0.1), mesh_b = test::sphere(2, 11);
  const Solid a(mesh_a), b(mesh_b);
  int overlapping = 0;
  for (int k = 0; k < 200; ++k) {
    const Pose X_WA = test::any_pose(random, 5), X_WB = test::any_pose(random, 25);
    const Pose X_AB = X_WA.inverse() * X_WB;
    const double expected = std::max(deepest_by_force(mesh_a, mesh_b, X_AB.inverse()),
                                     deepest_by_force(mesh_b, mesh_a, X_AB));
    const OverlapDepth found = overlap_depth(a, X_WA, b, X_WB);
    ASSERT_NEAR(found.depth_mm, expected, 1e-10);
    if (expected == 0) continue;
    ++overlapping;
    // The deepest point lies inside both, or on one, and the normal is unit.
    EXPECT_LE(a.signed_distance(X_WA.inverse() * found.point), 1e-9);
    EXPECT_LE(b.signed_distance(X_WB.inverse() * found.point), 1e-9);
    EXPECT_NEAR(found.normal.norm(), 1, 1e-9);
  }
  EXPECT_GT(overlapping, 60);
}

TEST(OverlapDepth, OfSpheresIsTheAnalyticOneWithinTheirFacets) {
  const Solid a(test::sphere(4, 20)), b(test::sphere(4, 10));
  const Pose X_WB{Eigen::Quaterniond::Identity(), {28, 0, 0}};
  const OverlapDepth found = overlap_depth(a, {}, b, X_WB);
  EXPECT_LE(found.depth_mm, 2.0);
  EXPECT_GE(found.depth_mm, 2.0 - 0.12);
  EXPECT_GT(found.normal.x(), 0.95);
  const OverlapDepth swapped = overlap_depth(b, X_WB, a, {});
  EXPECT_EQ(swapped.depth_mm, found.depth_mm);
  EXPECT_LT(swapped.normal.x(), -0.95);
}

TEST(OverlapDepth, GrowsByNoMoreThanTheMotion) {
  std::mt19937_64 random(21);
  const Solid a(test::sphere(3, 15, {0, 0, 0}, 0.1)), b(test::sphere(3, 10, {0, 0, 0}, 0.1));
  for (int k = 0; k < 100; ++k) {
    Pose X_WB = test::any_pose(random, 14);
    const double before = overlap_depth(a, {}, b, X_WB).depth_mm;
    const Eigen::Vector3d step = 0.3 * test::any_pose(random, 1).t;
    X_WB.t += step;
    EXPECT_LE(std::abs(overlap_depth(a, {}, b, X_WB).depth_mm - before), step.norm() + 1e-9);
  }
}

TEST(Solid, OverlappingShellsAreTheirUnion) {
  // Two boxes that overlap by 2 mm: a ball in the common part is as deep as in the deeper of them.
  const TriMesh pair =
      test::joined(test::box({0, 0, 0}, {10, 10, 10}), test::box({8, 0, 0}, {20, 10, 10}));
  const Solid solid(pair);
  EXPECT_EQ(solid.shell_count(), 2);
  EXPECT_EQ(solid.open_shell_count(), 0);
  EXPECT_NEAR(solid.signed_distance({9, 5, 5}), -1, 1e-12);
  EXPECT_NEAR(solid.signed_distance({8.5, 5, 5}), -1.5,
              1e-12);  // nearest shell alone would say -0.5
  EXPECT_NEAR(solid.signed_distance({23, 5, 5}), 3, 1e-12);
}

TEST(Solid, TurnsShellsThatFaceInwardAndPassesOverCavities) {
  TriMesh inward = test::sphere(2, 10);
  for (auto& t : inward.triangles) std::swap(t[1], t[2]);
  EXPECT_LT(Solid(inward).signed_distance({0, 0, 0}), -9);
  const Solid hollow(test::joined(test::sphere(2, 20), inward));
  EXPECT_LT(hollow.signed_distance({15, 0, 0}), -4);
  EXPECT_GT(hollow.signed_distance({30, 0, 0}), 9);
}

TEST(Solid, AnOpenShellHasNoInside) {
  TriMesh bowl = test::sphere(2, 10);
  bowl.triangles.pop_back();
  const Solid open(bowl), ball(test::sphere(1, 2));
  EXPECT_EQ(open.open_shell_count(), 1);
  EXPECT_FALSE(one_encloses_other(open, {}, ball, {}));
  EXPECT_EQ(overlap_depth(open, {}, ball, {}).depth_mm, 0);
}

TEST(Solid, ABodyWhollyInsideAnotherIsEnclosed) {
  const Solid big(test::sphere(3, 20)), small(test::sphere(2, 3));
  const Pose inside{Eigen::Quaterniond::Identity(), {5, 5, 5}};
  const Pose outside{Eigen::Quaterniond::Identity(), {30, 5, 5}};
  EXPECT_TRUE(one_encloses_other(big, {}, small, inside));
  EXPECT_TRUE(one_encloses_other(small, inside, big, {}));
  EXPECT_FALSE(one_encloses_other(big, {}, small, outside));
  // One of two balls inside is enough.
  const Solid both(test::joined(test::sphere(1, 1, {100, 0, 0}), test::sphere(1, 1, {2, 2, 2})));
  EXPECT_TRUE(one_encloses_other(big, {}, both, {}));
}

TEST(Solid, BallHoldsAllVertices) {
  std::mt19937_64 random(22);
  const TriMesh mesh = test::moved(test::sphere(3, 15, {2, 1, 0}, 0.2), test::any_pose(random, 30));
  const Solid solid(mesh);
  for (const auto& v : mesh.vertices)
    EXPECT_LE((v - solid.center()).norm(), solid.radius() + 1e-12);
}

}  // namespace
}  // namespace condyle
