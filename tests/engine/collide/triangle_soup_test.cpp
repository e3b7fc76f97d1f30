#include <gtest/gtest.h>

#include <random>

#include "engine/collide/collision_mesh.h"
#include "tests/engine/collide/triangle_oracle.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

enum class Kind { any, slivers, parallel, mixed };

/// Triangles without any connection.
TriMesh soup(Kind kind, int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> along(-1, 1);
  const auto any = [&](double size) -> Vector3d {
    return size * Vector3d(along(random), along(random), along(random));
  };
  TriMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Kind k = kind != Kind::mixed ? kind : static_cast<Kind>(i % 3);
    const Vector3d at = any(10);
    Vector3d u = any(2), v = any(2);
    if (k == Kind::slivers) v = 0.5 * u + any(1e-7);  // 1e-7 mm wide, the corner at the midpoint
    if (k == Kind::parallel) {                        // of one lattice
      u = {1.0 * static_cast<int>(3 * along(random)), 1, 0};
      v = {1, 1.0 * static_cast<int>(3 * along(random)), 0};
    }
    const int first = static_cast<int>(mesh.vertices.size());
    const Vector3d corner = k == Kind::parallel ? Vector3d(at.array().round()) : at;
    mesh.vertices.insert(mesh.vertices.end(), {corner, corner + u, corner + v});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

TEST(TriangleSoup, DistanceEqualsBruteForce) {
  std::mt19937_64 random(81);
  int apart = 0;
  for (const Kind a : {Kind::any, Kind::slivers, Kind::parallel, Kind::mixed})
    for (const Kind b : {Kind::any, Kind::slivers, Kind::parallel, Kind::mixed})
      for (int k = 0; k < 4; ++k) {
        const TriMesh mesh_a = soup(a, 60, random), mesh_b = soup(b, 60, random);
        const CollisionMesh tree_a(mesh_a), tree_b(mesh_b);
        Pose X = test::any_pose(random, 1);
        if (a == Kind::parallel && b == Kind::parallel) X.R.setIdentity();
        X.t = 5.0 * k * X.t.normalized();
        const double expected = test::brute_force_distance(mesh_a, {}, mesh_b, X);
        ASSERT_NEAR(distance(tree_a, {}, tree_b, X).distance_mm, expected, 1e-9)
            << static_cast<int>(a) << static_cast<int>(b) << k;
        apart += expected > 1e-6;
      }
  EXPECT_GT(apart, 20);
}

TEST(TriangleSoup, TouchingSharedAndContainedTrianglesAreAtNoDistance) {
  std::mt19937_64 random(82);
  const TriMesh one = soup(Kind::mixed, 40, random);
  const CollisionMesh tree(one);
  for (int k = 0; k < 20; ++k) {
    const Pose X = test::any_pose(random, 30);
    EXPECT_EQ(distance(tree, X, tree, X).distance_mm, 0);  // each triangle lies on itself
    // A triangle within a larger one, in its plane; one that only has a corner in common.
    TriMesh large, small, fan;
    large.vertices = {{-9, -9, 0}, {9, -9, 0}, {0, 12, 0}};
    small.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    fan.vertices = {{9, -9, 0}, {15, 0, 4}, {15, 0, -4}};
    large.triangles = small.triangles = fan.triangles = {{0, 1, 2}};
    const CollisionMesh l(test::moved(large, X)), s(test::moved(small, X)), f(test::moved(fan, X));
    EXPECT_NEAR(distance(l, {}, s, {}).distance_mm, 0, 1e-9);
    EXPECT_NEAR(distance(s, {}, l, {}).distance_mm, 0, 1e-9);
    EXPECT_NEAR(distance(l, {}, f, {}).distance_mm, 0, 1e-9);
  }
}

}  // namespace
}  // namespace condyle
