#include "engine/collide/collision_mesh.h"

#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "engine/mesh/triangle_tree.h"
#include "tests/engine/collide/triangle_oracle.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

/// Surfaces of 192 to 1280 triangles, round, bumpy, flat-sided, and open.
std::vector<TriMesh> specimens() {
  TriMesh bowl = test::sphere(3, 20);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.vertices[t[0]].z() > 0; });
  TriMesh wall;  // a box of boxes: many parallel edges and coplanar faces
  for (int i = 0; i < 16; ++i)
    wall = test::joined(wall, test::box({5.0 * (i % 4), 5.0 * (i / 4), 0},
                                        {5.0 * (i % 4) + 5, 5.0 * (i / 4) + 5, 5}));
  return {test::sphere(2, 15, {3, 0, 1}, 0.1), test::sphere(3, 18, {0, 0, 0}, 0.05), bowl, wall};
}

TEST(Distance, EqualsBruteForceColdAndWarmAtAnyPose) {
  std::mt19937_64 random(1);
  const auto meshes = specimens();
  std::vector<CollisionMesh> trees;
  for (const auto& mesh : meshes) trees.emplace_back(mesh);
  int apart = 0, crossing = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    for (std::size_t j = 0; j < meshes.size(); ++j) {
      TrianglePair last;
      for (int k = 0; k < 6; ++k) {
        const Pose X_WA = test::any_pose(random, 20), X_WB = test::any_pose(random, 40);
        const double expected = test::brute_force_distance(meshes[i], X_WA, meshes[j], X_WB);
        const MeshDistance cold = distance(trees[i], X_WA, trees[j], X_WB);
        const MeshDistance warm = distance(trees[i], X_WA, trees[j], X_WB, last);
        last = warm.triangles;
        ASSERT_NEAR(cold.distance_mm, expected, 1e-9);
        ASSERT_EQ(warm.distance_mm, cold.distance_mm);
        ASSERT_EQ(warm.triangles.a, cold.triangles.a);
        ASSERT_EQ(warm.triangles.b, cold.triangles.b);
        ASSERT_NEAR((cold.witness_a - cold.witness_b).norm(), cold.distance_mm, 1e-11);
        ASSERT_EQ(touching(trees[i], X_WA, trees[j], X_WB), expected == 0);
        ++(expected > 0 ? apart : crossing);
      }
    }
  EXPECT_GT(apart, 30);
  EXPECT_GT(crossing, 10);
}

TEST(Distance, WithinAReachIsTheDistanceOrNothing) {
  std::mt19937_64 random(14);
  const CollisionMesh a(test::sphere(3, 15, {3, 0, 1}, 0.1)), b(test::sphere(3, 12));
  int found = 0, beyond = 0;
  for (int k = 0; k < 60; ++k) {
    const Pose X_WA = test::any_pose(random, 20), X_WB = test::any_pose(random, 30);
    const MeshDistance all = distance(a, X_WA, b, X_WB);
    for (const double reach : {0.5 * all.distance_mm, 1.001 * all.distance_mm + 1e-9, 30.0}) {
      const auto within = distance_within(reach, a, X_WA, b, X_WB, all.triangles);
      ASSERT_EQ(within.has_value(), all.distance_mm < reach);
      if (within) {
        EXPECT_NEAR(within->distance_mm, all.distance_mm, 1e-12);
      }
      ++(within ? found : beyond);
    }
  }
  EXPECT_GT(found, 50);
  EXPECT_GT(beyond, 30);
}

TEST(Distance, EqualsBruteForceWhereEdgesAreParallel) {
  // The wall slides along itself, both turned alike: parallel edges and faces to rounding.
  std::mt19937_64 random(2);
  const TriMesh wall = specimens()[3];
  const CollisionMesh tree(wall);
  std::uniform_int_distribution<int> step(-6, 6);
  TrianglePair last;
  int apart = 0;
  for (int k = 0; k < 80; ++k) {
    const Pose turn = test::any_pose(random, 30);
    const Eigen::Vector3d shift(5.0 * step(random), 2.5 * step(random), 1.25 * step(random));
    const Pose X_WB = turn * Pose{Eigen::Quaterniond::Identity(), shift};
    const double expected = test::brute_force_distance(wall, {}, wall, {turn.R.Identity(), shift});
    if (expected < 1e-9) continue;
    const MeshDistance cold = distance(tree, turn, tree, X_WB);
    const MeshDistance warm = distance(tree, turn, tree, X_WB, last);
    last = warm.triangles;
    ASSERT_NEAR(cold.distance_mm, expected, 1e-9);
    ASSERT_NEAR(warm.distance_mm, expected, 1e-9);
    ++apart;
  }
  EXPECT_GT(apart, 30);
}

TEST(Distance, WitnessPointsLieOnTheirTriangles) {
  std::mt19937_64 random(3);
  const auto meshes = specimens();
  const CollisionMesh a(meshes[0]), b(meshes[1]);
  for (int k = 0; k < 20; ++k) {
    const Pose X_WB = test::any_pose(random, 60);
    const MeshDistance found = distance(a, {}, b, X_WB);
    const auto ta = test::corners_of(meshes[0], found.triangles.a, {});
    const auto tb = test::corners_of(meshes[1], found.triangles.b, X_WB);
    const auto at = [](const Eigen::Vector3d& p) {
      const test::Point q = p.cast<test::Real>();
      return test::Corners{q, q, q};
    };
    EXPECT_NEAR(static_cast<double>(test::triangle_distance_oracle(at(found.witness_a), ta)), 0,
                1e-11);
    EXPECT_NEAR(static_cast<double>(test::triangle_distance_oracle(at(found.witness_b), tb)), 0,
                1e-11);
  }
}

TEST(Distance, OfSpheresIsTheAnalyticOneWithinTheirFacets) {
  const double radius = 20, gap = 7;
  const CollisionMesh a(test::sphere(4, radius)), b(test::sphere(4, radius));
  std::mt19937_64 random(4);
  // A facet of 2 mm edges lies at most edge^2 / (6 r) = 0.06 mm under its sphere.
  for (int k = 0; k < 10; ++k) {
    Pose X_WB = test::any_pose(random, 1);
    X_WB.t = (2 * radius + gap) * X_WB.t.normalized();
    const double found = distance(a, {}, b, X_WB).distance_mm;
    EXPECT_GE(found, gap);
    EXPECT_LE(found, gap + 0.12);
  }
}

TEST(Distance, AMovedSceneGivesTheSameDistanceAndTheMovedPoints) {
  std::mt19937_64 random(5);
  const auto meshes = specimens();
  const CollisionMesh a(meshes[0]), b(meshes[1]);
  for (int k = 0; k < 10; ++k) {
    const Pose X_WB = {test::any_pose(random, 1).R, {50, 5, -3}},
               move = test::any_pose(random, 100);
    const MeshDistance here = distance(a, {}, b, X_WB), there = distance(a, move, b, move * X_WB);
    EXPECT_NEAR(there.distance_mm, here.distance_mm, 1e-11);
    EXPECT_NEAR((there.witness_a - move * here.witness_a).norm(), 0,
                1e-6);  // unique for bumpy shapes
  }
}

TEST(Distance, TwoThreadsOnOnePairAreBitIdentical) {
  const CollisionMesh a(test::sphere(4, 20, {0, 0, 0}, 0.05)),
      b(test::sphere(4, 20, {0, 0, 0}, 0.05));
  std::mt19937_64 random(6);
  std::vector<Pose> poses;
  for (int k = 0; k < 40; ++k) poses.push_back(test::any_pose(random, 60));
  std::vector<double> first(poses.size()), second(poses.size());
  const auto work = [&](std::vector<double>& out) {
    for (std::size_t k = 0; k < poses.size(); ++k)
      out[k] = distance(a, {}, b, poses[k]).distance_mm;
  };
  std::thread other([&] { work(second); });
  work(first);
  other.join();
  EXPECT_EQ(first, second);
}

TEST(Contacts, AreExactlyTheCrossingTrianglesAndLieOnBoth) {
  std::mt19937_64 random(12);
  const TriMesh mesh_a = test::sphere(2, 15, {0, 0, 0}, 0.1), mesh_b = test::sphere(2, 10);
  const CollisionMesh a(mesh_a), b(mesh_b);
  const TriangleTree surface_a(mesh_a), surface_b(mesh_b);
  std::size_t total = 0;
  for (int k = 0; k < 4; ++k) {
    const Pose X_WA = test::any_pose(random, 5), X_WB = test::any_pose(random, 8);
    std::size_t expected = 0;
    for (std::size_t i = 0; i < mesh_a.triangles.size(); ++i)
      for (std::size_t j = 0; j < mesh_b.triangles.size(); ++j)
        expected += test::triangle_distance_oracle(test::corners_of(mesh_a, i, X_WA),
                                                   test::corners_of(mesh_b, j, X_WB)) == 0;
    const auto found = contacts(a, X_WA, b, X_WB);
    EXPECT_EQ(found.size(), expected);
    total += found.size();
    for (const auto& contact : found) {
      EXPECT_NEAR(contact.normal.norm(), 1, 1e-12);
      EXPECT_LT(surface_a.nearest(X_WA.inverse() * contact.point).distance, 1e-9);
      EXPECT_LT(surface_b.nearest(X_WB.inverse() * contact.point).distance, 1e-9);
      EXPECT_GE(overlap(a, X_WA, b, X_WB, contact.triangles), 0);
    }
    EXPECT_LE(contacts(a, X_WA, b, X_WB, {.total = 5}).size(), 5u);
  }
  EXPECT_GT(total, 100u);
}

TEST(Contacts, NormalsPointFromAToB) {
  const CollisionMesh a(test::sphere(3, 10)), b(test::sphere(3, 10));
  const auto found = contacts(a, {}, b, {Eigen::Quaterniond::Identity(), {19.5, 0.3, 0.2}});
  ASSERT_FALSE(found.empty());
  for (const auto& contact : found) EXPECT_GT(contact.normal.x(), 0.9);
}

TEST(Contacts, AQuotaForEachRegionSpreadsThemOverTheSurface) {
  const CollisionMesh a(test::sphere(5, 20)), b(test::sphere(5, 20));
  const Pose X_WB{Eigen::Quaterniond::Identity(), {15, 0, 0}};  // they cross in a circle
  const auto all = contacts(a, {}, b, X_WB), some = contacts(a, {}, b, X_WB, {.per_region = 2});
  ASSERT_GT(all.size(), 150u);
  ASSERT_LT(some.size(), all.size() / 3);
  for (int quadrant = 0; quadrant < 4; ++quadrant) {
    const Eigen::Vector3d corner(0, quadrant & 1 ? 1 : -1, quadrant & 2 ? 1 : -1);
    EXPECT_TRUE(std::any_of(some.begin(), some.end(), [&](const MeshContact& contact) {
      return contact.point.y() * corner.y() > 0 && contact.point.z() * corner.z() > 0;
    }));
  }
}

}  // namespace
}  // namespace condyle
