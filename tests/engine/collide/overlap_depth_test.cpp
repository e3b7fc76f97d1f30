#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/overlap_measure.h"
#include "tests/engine/collide/prisms.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::shift;

/// Deepest of many points of the surface, by the definition.
double deepest_sample(const TriMesh& points, const TriMesh& solid, const Pose& X, int divisions) {
  const TriangleTree tree(solid);
  double deepest = 0;
  for (const auto& t : points.triangles)
    for (int i = 0; i <= divisions; ++i)
      for (int j = 0; i + j <= divisions; ++j) {
        const double u = 1.0 * i / divisions, v = 1.0 * j / divisions;
        const Vector3d p = (1 - u - v) * points.vertices[t[0]] + u * points.vertices[t[1]] +
                           v * points.vertices[t[2]];
        deepest = std::max(deepest, -tree.signed_distance(X * p));
      }
  return deepest;
}

TEST(OverlapDepth, IsNoLessThanAtAnyPointAndIsReachedAtItsOwn) {
  std::mt19937_64 random(20);
  const TriMesh mesh_a = test::sphere(2, 15, {2, 1, 0}, 0.1), mesh_b = test::sphere(1, 11);
  const Solid a(mesh_a), b(mesh_b);
  const TriangleTree tree_a(mesh_a), tree_b(mesh_b);
  int overlapping = 0;
  for (int k = 0; k < 60; ++k) {
    const Pose X_WA = test::any_pose(random, 5), X_WB = test::any_pose(random, 25);
    const Pose X_AB = X_WA.inverse() * X_WB;
    const double sampled = std::max(deepest_sample(mesh_a, mesh_b, X_AB.inverse(), 4),
                                    deepest_sample(mesh_b, mesh_a, X_AB, 8));
    const OverlapDepth found = overlap_depth(a, X_WA, b, X_WB);
    ASSERT_GE(found.depth_mm + found.error_mm, sampled - 1e-9);
    ASSERT_LE(found.error_mm, std::max(2e-4, 1e-3 * found.depth_mm));
    if (found.depth_mm == 0) continue;
    ++overlapping;
    // On one surface, inside the other: the two distances there are 0 and the depth.
    const double in_a = tree_a.signed_distance(X_WA.inverse() * found.point);
    const double in_b = tree_b.signed_distance(X_WB.inverse() * found.point);
    EXPECT_NEAR(std::max(in_a, in_b), 0, 1e-9);
    EXPECT_NEAR(std::min(in_a, in_b), -found.depth_mm, 1e-9);
    EXPECT_NEAR(found.normal.norm(), 1, 1e-9);
  }
  EXPECT_GT(overlapping, 20);
}

TEST(OverlapDepth, IsTheSameWhereTheCrossingFacesAreKnown) {
  std::mt19937_64 random(24);
  const TriMesh mesh_a = test::sphere(3, 15, {2, 1, 0}, 0.1),
                mesh_b = test::joined(test::sphere(3, 10, {0, 0, 0}, 0.1),
                                      test::sphere(2, 6, {0, 18, 0}, 0.1));
  const Solid a(mesh_a), b(mesh_b);
  const CollisionMesh surface_a(mesh_a), surface_b(mesh_b);
  int crossed = 0;
  for (int k = 0; k < 60; ++k) {
    const Pose X_WB = test::any_pose(random, 14);
    CrossingFaces crossing;
    for (const auto& contact : contacts(surface_a, {}, surface_b, X_WB)) {
      crossing.a.push_back(contact.triangles.a);
      crossing.b.push_back(contact.triangles.b);
    }
    const OverlapDepth found = overlap_depth(a, {}, b, X_WB),
                       spared = overlap_depth(a, {}, b, X_WB, {}, &crossing);
    EXPECT_NEAR(spared.depth_mm, found.depth_mm, std::max(found.error_mm, spared.error_mm));
    EXPECT_LE(spared.error_mm, std::max(2e-4, 1e-3 * spared.depth_mm));
    crossed += !crossing.a.empty();
  }
  EXPECT_GT(crossed, 20);
}

TriMesh faces_of(const TriMesh& mesh, const std::vector<int>& triangles) {
  TriMesh faces{mesh.vertices, {}, {}};
  for (const int t : triangles) faces.triangles.push_back(mesh.triangles[t]);
  return faces;
}

/// A jaw held by its bite overlaps by some micrometres, on faces of a millimetre: halving the faces
/// alone took two to eight times as many evaluations.
TEST(OverlapDepth, OfAShallowContactIsProvedByFewEvaluations) {
  std::mt19937_64 random(26);
  const TriMesh mesh_a = test::sphere(5, 6), mesh_b = test::sphere(5, 4);
  const Solid a(mesh_a), b(mesh_b);
  const CollisionMesh surface_a(mesh_a), surface_b(mesh_b);
  int proved = 0;
  for (const auto& [lens_mm, most] : {std::pair(0.005, 800), {0.01, 800}, {0.05, 1600}})
    for (int k = 0; k < 8; ++k) {
      const Pose X_WB{test::any_pose(random, 1).R,
                      (10 - lens_mm) * test::any_pose(random, 1).t.normalized()};
      CrossingFaces crossing;
      for (const auto& contact : contacts(surface_a, {}, surface_b, X_WB)) {
        crossing.a.push_back(contact.triangles.a);
        crossing.b.push_back(contact.triangles.b);
      }
      if (crossing.a.empty()) continue;  // facets lie up to 0.003 mm within the spheres
      const OverlapDepth found =
          overlap_depth(a, {}, b, X_WB, {.max_evaluations = most}, &crossing);
      EXPECT_LE(found.error_mm, 2e-4);
      EXPECT_GT(found.depth_mm, std::max(0.0, lens_mm - 0.006));
      EXPECT_LE(found.depth_mm, lens_mm);
      // Among the faces that cross, where the deepest point is.
      const double sampled =
          std::max(deepest_sample(faces_of(mesh_a, crossing.a), mesh_b, X_WB.inverse(), 6),
                   deepest_sample(faces_of(mesh_b, crossing.b), mesh_a, X_WB, 6));
      EXPECT_GT(sampled, 0);
      EXPECT_GE(found.depth_mm + found.error_mm, sampled - 1e-9);
      ++proved;
    }
  EXPECT_GT(proved, 15);
}

/// Where a face lies above a plane except for a corner within rounding, a cut made slivers that
/// were cut again and again: these searches ended too early, 0.01 mm short.
TEST(OverlapDepth, IsProvedWhereAPlaneTouchesTheCornerOfAPart) {
  for (const unsigned seed : {928u, 1369u, 2791u, 3049u}) {
    SCOPED_TRACE(seed);
    const int number = static_cast<int>(seed);
    const TriMesh mesh_a = test::sphere(1 + number % 3, 6, {0, 0, 0}, 0.1 * (number % 4)),
                  mesh_b = test::sphere(1 + number / 3 % 4, 1 + number % 5, {0, 0, 0},
                                        0.1 * (number % 3));
    std::mt19937_64 random(seed);
    const Pose X = test::any_pose(random, 7);
    const OverlapDepth found =
        overlap_depth(Solid(mesh_a), {}, Solid(mesh_b), X, {.max_evaluations = 5000});
    EXPECT_LE(found.error_mm, std::max(2e-4, 1e-3 * found.depth_mm));
    EXPECT_GE(found.depth_mm + found.error_mm,
              std::max(deepest_sample(mesh_a, mesh_b, X.inverse(), 16),
                       deepest_sample(mesh_b, mesh_a, X, 16)));
  }
}

TEST(OverlapDepth, GrowsByNoMoreThanTheMotion) {
  std::mt19937_64 random(21);
  const Solid a(test::sphere(3, 15, {0, 0, 0}, 0.1)), b(test::sphere(3, 10, {0, 0, 0}, 0.1));
  for (int k = 0; k < 100; ++k) {
    Pose X_WB = test::any_pose(random, 14);
    const OverlapDepth before = overlap_depth(a, {}, b, X_WB);
    const Vector3d step = 0.3 * test::any_pose(random, 1).t;
    X_WB.t += step;
    const OverlapDepth after = overlap_depth(a, {}, b, X_WB);
    EXPECT_LE(std::abs(after.depth_mm - before.depth_mm),
              step.norm() + std::max(before.error_mm, after.error_mm));
  }
}

TEST(OverlapDepth, SwappedBodiesHaveTheSameDepthAndTheOppositeNormal) {
  const Solid a(test::sphere(4, 20)), b(test::sphere(4, 10));
  const OverlapDepth found = overlap_depth(a, {}, b, shift(28, 0, 0)),
                     swapped = overlap_depth(b, shift(28, 0, 0), a, {});
  EXPECT_NEAR(swapped.depth_mm, found.depth_mm, 2e-3);
  EXPECT_GT(found.normal.x(), 0.95);
  EXPECT_LT(swapped.normal.x(), -0.95);
}

/// Depth and volume of a pair against the formulas, in any pose of the two together.
void expect_overlap(const TriMesh& a, const TriMesh& b, const Pose& X_AB, double depth,
                    double volume, std::mt19937_64& random, double proved_mm = 0) {
  const double proved = proved_mm > 0 ? proved_mm : std::max(2.1e-4, 0.005 * depth);
  const Solid solid_a(a), solid_b(b);
  for (int k = 0; k < 2; ++k) {
    const Pose X = test::any_pose(random, 60);
    const OverlapDepth found = overlap_depth(solid_a, X, solid_b, X * X_AB);
    EXPECT_NEAR(found.depth_mm, depth, 0.01 * depth);
    EXPECT_LE(found.error_mm, proved);
    EXPECT_NEAR(overlap_volume(a, X, b, X * X_AB).mm3, volume, 0.01 * volume);
  }
}

using std::numbers::pi;

TEST(Overlap, OfSpheresIsTheirLens) {
  std::mt19937_64 random(22);
  for (const double R : {3.0, 12.0, 40.0})
    for (const double fraction : {0.05, 0.3, 1.0}) {  // of the smaller radius
      const double r = 0.6 * R, depth = fraction * r, d = R + r - depth;
      // Facets press in by edge^2 / (6 r): by less than a thousandth of these depths.
      const double lens =
          depth * depth * pi * (d * d + 2 * d * (R + r) - 3 * (R - r) * (R - r)) / (12 * d);
      const Vector3d direction = test::any_pose(random, 1).t.normalized();
      SCOPED_TRACE(testing::Message() << R << " mm, depth " << depth);
      expect_overlap(test::sphere(6, R), test::sphere(6, r),
                     {test::any_pose(random, 1).R, d * direction}, depth, lens, random);
    }
}

TEST(Overlap, OfBoxesFaceToFaceAndCornerToFace) {
  std::mt19937_64 random(23);
  for (const double size : {0.1, 1.0, 10.0})
    for (const double depth : {0.05 * size, 0.5 * size, 0.9 * size}) {
      SCOPED_TRACE(testing::Message() << size << " mm, depth " << depth);
      const TriMesh floor = test::box(size * Vector3d(-4, -3, -2), size * Vector3d(4, 3, 0)),
                    cube = test::box(Vector3d::Zero(), Vector3d::Constant(size));
      expect_overlap(floor, cube, shift(-size, -0.3 * size, -depth), depth, size * size * depth,
                     random);
      const Pose on_corner{Quaterniond::FromTwoVectors(Vector3d::Ones(), Vector3d::UnitZ()),
                           {0, 0, -depth}};
      if (depth < size / std::sqrt(3.0))  // a tetrahedron
        expect_overlap(floor, cube, on_corner, depth, std::sqrt(3.0) / 2 * std::pow(depth, 3),
                       random);
    }
}

/// A groove with sides at `half` to its middle plane, along y, its bottom line at z = 0.
TriMesh groove(double half, double depth, double length) {
  const double x = depth * std::tan(half);
  return test::prism({{-2 * x, -depth},
                      {2 * x, -depth},
                      {2 * x, depth},
                      {x, depth},
                      {0, 0},
                      {-x, depth},
                      {-2 * x, depth}},
                     length);
}

TEST(Overlap, OfACapsuleInAGrooveIsTwoSegmentsAndTwoCaps) {
  // Each side cuts off the depth d: a circular segment times the cylinder's length, and the two
  // halves of a ball's cap. The two sides' parts stay apart while d is below 0.29 r. Along the
  // whole capsule it is equally deep: proving that nothing is deeper takes long.
  std::mt19937_64 random(24);
  const double half = pi / 4, length = 12;
  for (const double r : {2.0, 5.0})
    for (const double fraction : {0.02, 0.1, 0.25}) {
      const double d = fraction * r, theta = std::acos(1 - fraction);
      SCOPED_TRACE(testing::Message() << "radius " << r << ", depth " << d);
      const double segment = r * r * (theta - std::sin(theta) * std::cos(theta));
      const double cap = pi * d * d * (3 * r - d) / 3;
      const Pose X{Quaterniond::Identity(), {0, 0, (r - d) / std::sin(half)}};
      expect_overlap(groove(half, 3 * r, 3 * length), test::capsule(r, length, 256), X, d,
                     2 * (segment * length + cap), random, 0.5);
    }
}

TEST(Overlap, OfCrossedRidgesIsOnTheirEdgesWhereNoVertexIs) {
  // Two roofs of 90 degrees, edge across edge, the upper one sunk in by h.
  std::mt19937_64 random(25);
  const TriMesh ridge = test::prism({{-6, -6}, {6, -6}, {0, 0}}, 40);
  const Pose over{Quaterniond(Eigen::AngleAxisd(pi, Vector3d::UnitX()) *
                              Eigen::AngleAxisd(pi / 2, Vector3d::UnitZ())),
                  {1, -2, 0}};
  for (const double h : {0.05, 0.4, 2.0}) {
    Pose X = over;
    X.t.z() = -h;
    SCOPED_TRACE(testing::Message() << "height " << h);
    // |x| <= -z below and |y| <= z + h above: the area at z is 4 (-z)(z + h), over the height
    // 4 h^3 / 6. The edge point over the crossing lies h above it, and its sides lean by 45
    // degrees.
    expect_overlap(ridge, ridge, X, h / std::sqrt(2.0), 2 * h * h * h / 3, random);
  }
}

TEST(Overlap, OfAFlatFaceOnARoundOneIsInsideTheFace) {
  // The box's corners are far outside the ball, and the ball's vertices need not lie lowest.
  std::mt19937_64 random(26);
  const double R = 8;
  for (const double depth : {0.1, 1.0}) {
    Pose X = test::any_pose(random, 1);
    X.t = {3, 2, R - depth};
    expect_overlap(test::box({-30, -30, -9}, {30, 30, 0}), test::sphere(6, R), X, depth,
                   pi * depth * depth * (3 * R - depth) / 3, random);
  }
}

TEST(OverlapDepth, OfFlatFacesOfManyTrianglesEndsSoon) {
  // Equally deep everywhere: the search may stop early, but reports what it may have missed.
  TriMesh floor;
  const int n = 60;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) floor.vertices.emplace_back(0.5 * i, 0.5 * j, 0);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int v = i * (n + 1) + j;
      floor.triangles.emplace_back(v, v + n + 1, v + 1);
      floor.triangles.emplace_back(v + 1, v + n + 1, v + n + 2);
    }
  const TriMesh slab = test::extruded(floor, 3);
  const Solid a(slab);
  for (const double depth : {0.02, 0.5}) {
    const Pose X{Quaterniond(Eigen::AngleAxisd(pi, Vector3d::UnitX())), {0.2, 29.7, -depth}};
    const OverlapDepth found = overlap_depth(a, {}, a, X, {.max_evaluations = 5000});
    EXPECT_NEAR(found.depth_mm, depth, 1e-9);
    EXPECT_LT(found.error_mm, 0.75);
  }
}

}  // namespace
}  // namespace condyle
