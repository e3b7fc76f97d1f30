#include "engine/collide/solid.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <thread>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "tests/support/allocated.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

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

TEST(Solid, TakesLittleMemoryUntilADepthIsAsked) {
  const TriMesh mesh = test::sphere(5, 20);
  const std::size_t before = allocated_bytes();
  const Solid solid(mesh);
  const std::size_t unasked = allocated_bytes() - before;
  EXPECT_EQ(solid.face_count(), mesh.triangles.size());
  EXPECT_NEAR(solid.radius(), 20, 1e-9);
  EXPECT_EQ(allocated_bytes() - before, unasked);
  const Solid away(test::sphere(1, 1, {30, 0, 0}));
  EXPECT_FALSE(one_encloses_other(solid, {}, away, {}));
  EXPECT_LT(allocated_bytes() - before, 2 * unasked);
  EXPECT_GT(overlap_depth(solid, {}, Solid(test::sphere(1, 3, {20, 0, 0})), {}).depth_mm, 1);
  EXPECT_GT(allocated_bytes() - before, 2 * unasked);
}

TEST(Solid, ThreadsThatAskAtOnceFindTheSame) {
  const TriMesh mesh = test::sphere(5, 20, {0, 0, 0}, 0.2);
  const Solid ball(test::sphere(3, 5, {18, 1, 2}));
  const OverlapDepth alone = overlap_depth(Solid(mesh), {}, ball, {});
  EXPECT_GT(alone.depth_mm, 1);
  const Solid shared(mesh);
  std::array<OverlapDepth, 4> found;
  {
    std::vector<std::jthread> threads;
    for (OverlapDepth& one : found)
      threads.emplace_back([&] { one = overlap_depth(shared, {}, ball, {}); });
  }
  for (const OverlapDepth& one : found) {
    EXPECT_EQ(one.depth_mm, alone.depth_mm);
    EXPECT_EQ(one.point, alone.point);
    EXPECT_EQ(one.normal, alone.normal);
  }
}

}  // namespace
}  // namespace condyle
