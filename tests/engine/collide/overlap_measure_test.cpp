#include "engine/collide/overlap_measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "engine/mesh/refine.h"
#include "engine/mesh/topology.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using test::any_pose;
using test::box;
using test::sphere;

using std::numbers::pi;

TEST(OverlapVolume, SpheresInAnyPoseGiveTheLens) {
  std::mt19937_64 random(11);
  const double R = 12, r = 7;
  const TriMesh a = sphere(6, R), b = sphere(6, r);  // facets press in by less than 0.004 mm
  for (const double apart : {18.5, 16.0, 12.0, 6.0}) {
    const Pose X_WA = any_pose(random, 80);
    Pose X_AB = any_pose(random, 1);
    X_AB.t = apart * X_AB.t.normalized();
    const auto found = overlap_volume(a, X_WA, b, X_WA * X_AB);
    const double s = R + r - apart;
    const double lens =
        s * s * pi * (apart * apart + 2 * apart * (R + r) - 3 * (R - r) * (R - r)) / (12 * apart);
    EXPECT_NEAR(found.mm3, lens, 0.01 * lens) << apart;
    EXPECT_LT(found.error_mm3, 0.01 * lens) << apart;
  }
}

TEST(OverlapVolume, BoxesInAnyPose) {
  std::mt19937_64 random(12);
  const TriMesh a = box({-20, -15, -10}, {20, 15, 10}), b = box({-5, -4, -3}, {5, 4, 3});
  for (int i = 0; i < 5; ++i) {
    const Pose X_WA = any_pose(random, 50);
    const Pose pressed{Eigen::Quaterniond::Identity(), {18, 2, 9.5}};
    EXPECT_NEAR(overlap_volume(a, X_WA, b, X_WA * pressed).mm3, 7 * 8 * 3.5, 0.01 * 196) << i;
    Pose within = any_pose(random, 2);  // turned, but wholly inside
    EXPECT_NEAR(overlap_volume(a, X_WA, b, X_WA * within).mm3, 480, 0.01 * 480) << i;
    EXPECT_NEAR(overlap_volume(b, X_WA * within, a, X_WA).mm3, 480, 0.01 * 480) << i;
    // A corner cut off by a face: a tetrahedron of height 1.2 on the body diagonal.
    const TriMesh cube = box({0, 0, 0}, {10, 10, 10});
    Pose corner;
    corner.R =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::Ones(), Eigen::Vector3d::UnitZ());
    corner.t = {0, 0, 10 - 1.2};
    const double tetrahedron = std::sqrt(3.0) / 2 * 1.2 * 1.2 * 1.2;
    EXPECT_NEAR(overlap_volume(a, X_WA, cube, X_WA * corner).mm3, tetrahedron, 0.01 * tetrahedron);
    const Pose away{Eigen::Quaterniond::Identity(), {0, 0, 13.001}};
    EXPECT_EQ(overlap_volume(a, X_WA, b, X_WA * away).mm3, 0);
  }
}

TEST(OverlapVolume, SmallAndNarrowOverlapsAreMeasuredAsWell) {
  std::mt19937_64 random(17);
  const TriMesh slab = box({-20, -15, -10}, {20, 15, 0}), cube = box({-7, 0, 0}, {7, 10, 10});
  for (const double deep : {2.0, 0.5, 0.1}) {
    const Pose X = any_pose(random, 50);
    // An edge of 14 mm pressed in, and a corner.
    Pose ridge;
    ridge.R = Eigen::AngleAxisd(pi / 4, Eigen::Vector3d::UnitX());
    ridge.t = {1, 2, -deep};
    const double wedge = deep * deep * 14;
    EXPECT_NEAR(overlap_volume(slab, X, cube, X * ridge).mm3, wedge, 0.01 * wedge) << deep;
    Pose tip;
    tip.R = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::Ones(), Eigen::Vector3d::UnitZ());
    tip.t = Eigen::Vector3d(3, -4, -deep);
    const double tetrahedron = std::sqrt(3.0) / 2 * deep * deep * deep;
    EXPECT_NEAR(overlap_volume(slab, X, box({0, 0, 0}, {10, 10, 10}), X * tip).mm3, tetrahedron,
                0.01 * tetrahedron)
        << deep;
  }
}

TEST(OverlapVolume, CavityIsNotInside) {
  TriMesh hollow = box({-10, -10, -10}, {10, 10, 10}), hole = box({-6, -6, -6}, {6, 6, 6});
  for (auto& t : hole.triangles) std::swap(t[1], t[2]);
  hollow = test::joined(hollow, hole);
  std::mt19937_64 random(13);
  const Pose X = any_pose(random, 30);
  EXPECT_NEAR(overlap_volume(hollow, X, box({-20, -20, 0}, {20, 20, 20}), X).mm3,
              (8000 - 1728) / 2.0, 40);
}

TEST(ContactRegion, SpherePressedIntoABoxGivesTheCap) {
  std::mt19937_64 random(14);
  const double R = 9;
  const SignedSurface a(box({-30, -30, -30}, {30, 30, 0}));
  const TriMesh b = sphere(5, R);
  for (const double depth : {0.0, 0.3, 2.0, 6.0}) {
    const Pose X_WA = any_pose(random, 60);
    Pose X_AB = any_pose(random, 1);
    X_AB.t = {4, -7, R - depth};
    const auto region = contact_region(a, X_WA, b, X_WA * X_AB);
    const double cap = 2 * pi * R * (depth + 0.1);
    EXPECT_NEAR(region.area_mm2, cap, 0.02 * cap) << depth;
    ASSERT_EQ(region.patches.size(), 1u) << depth;
    EXPECT_NEAR(region.patches[0].depth_mm, depth, 0.02);
    EXPECT_LT((region.normal - X_WA.R * Eigen::Vector3d::UnitZ()).norm(), 0.01);
    const Eigen::Vector3d centroid = X_WA.inverse() * region.centroid;
    EXPECT_LT((centroid.head<2>() - Eigen::Vector2d(4, -7)).norm(), 0.05);
  }
}

TEST(ContactRegion, TwoFeetOfBigTrianglesAreTwoPatches) {
  std::mt19937_64 random(15);
  const SignedSurface floor(box({-50, -50, -20}, {50, 50, 0}));
  const TriMesh feet = test::joined(box({-20, -5, -1}, {-10, 5, 9}), box({12, -3, -2}, {18, 3, 9}));
  const Pose X = any_pose(random, 40);
  const auto region = contact_region(floor, X, feet, X);
  ASSERT_EQ(region.patches.size(), 2u);
  // Bottom and the sides up to 0.1 mm above the floor.
  EXPECT_NEAR(region.patches[0].area_mm2, 100 + 40 * 1.1, 0.01 * 144);
  EXPECT_NEAR(region.patches[1].area_mm2, 36 + 24 * 2.1, 0.01 * 86.4);
  EXPECT_NEAR(region.patches[0].depth_mm, 1, 1e-9);
  EXPECT_NEAR(region.patches[1].depth_mm, 2, 1e-9);
  EXPECT_TRUE(contact_region(floor, X, feet, X * Pose{Eigen::Quaterniond::Identity(), {0, 0, 2.2}})
                  .patches.empty());
}

TEST(SignedSurface, OpenShellsHaveAnUnsignedDistance) {
  TriMesh cup = box({-5, -5, -5}, {5, 5, 5});
  cup.triangles.pop_back();
  const SignedSurface open(cup), closed(box({-5, -5, -5}, {5, 5, 5}));
  EXPECT_FALSE(open.has_inside());
  EXPECT_TRUE(open.has_open_shells());
  EXPECT_NEAR(open.distance({0, 0, -4}), 1, 1e-12);
  EXPECT_NEAR(closed.distance({0, 0, -4}), -1, 1e-12);
  EXPECT_TRUE(closed_shells(cup).empty());
  // Both kinds in one mesh: the inside of the closed shell is still known.
  const SignedSurface both(test::joined(cup, box({20, -5, -5}, {30, 5, 5})));
  EXPECT_NEAR(both.distance({22, 0, 0}), -2, 1e-12);
  EXPECT_NEAR(both.distance({0, 0, -6}), 1, 1e-12);
  const std::vector<Eigen::Vector3d> points = {{22, 0, 0}, {0, 0, 300}};
  const auto found = distances_to(both, Pose{}, points, 5, 2);
  EXPECT_FLOAT_EQ(found[0], -2);
  EXPECT_TRUE(std::isinf(found[1]));
}

TEST(SignedSurface, OfManyShellsIsTheLeastOverThem) {
  std::mt19937_64 random(16);
  TriMesh all;
  std::vector<TriangleTree> trees;
  for (int i = 0; i < 9; ++i) {
    const TriMesh shell = test::moved(sphere(2, 3 + i % 4, {0, 0, 0}, 0.1), any_pose(random, 12));
    trees.emplace_back(shell);
    all = test::joined(all, shell);
  }
  const SignedSurface surface(all);
  std::uniform_real_distribution<double> along(-20, 20);
  int inside = 0;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d p(along(random), along(random), along(random));
    double least = std::numeric_limits<double>::infinity();
    for (const auto& tree : trees) least = std::min(least, tree.signed_distance(p));
    ASSERT_EQ(surface.distance(p), least);
    inside += least < 0;
  }
  EXPECT_GT(inside, 100);
}

TEST(Refine, DividesInTheBallAndStaysClosed) {
  const Eigen::Vector3d center(5, 1, 2);
  const TriMesh fine = refine_near(box({-40, -30, -20}, {40, 30, 2}), center, 6, 0.5);
  EXPECT_TRUE(inspect(fine).closed());
  EXPECT_NEAR(surface_area(fine), 2 * (80 * 60 + 80 * 22 + 60 * 22), 1e-6);
  int inside = 0;
  for (const auto& t : fine.triangles) {
    const Eigen::Vector3d middle =
        (fine.vertices[t[0]] + fine.vertices[t[1]] + fine.vertices[t[2]]) / 3;
    if ((middle - center).norm() > 5) continue;
    ++inside;
    for (int k = 0; k < 3; ++k)
      EXPECT_LE((fine.vertices[t[k]] - fine.vertices[t[(k + 1) % 3]]).norm(), 0.5);
  }
  EXPECT_GT(inside, 500);
  EXPECT_LT(fine.triangles.size(), 20000u);
}

}  // namespace
}  // namespace condyle
