#include "engine/mesh/triangle_tree.h"

#include <gtest/gtest.h>

#include <thread>

#include "engine/mesh/repair.h"
#include "tests/engine/mesh/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using test::arbitrary_pose;
using test::cuboid;
using test::moved;
using test::sphere;

/// Distance to a triangle by projection on its plane, edges and corners: an independent method.
double distance_by_cases(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                         const Vector3d& p) {
  const auto to_edge = [&](const Vector3d& u, const Vector3d& v) {
    const double s = std::clamp((p - u).dot(v - u) / (v - u).squaredNorm(), 0.0, 1.0);
    return (u + s * (v - u) - p).norm();
  };
  double best = std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
  const Vector3d n = (b - a).cross(c - a).normalized(), q = p - n.dot(p - a) * n;
  const bool inside = (b - a).cross(q - a).dot(n) >= 0 && (c - b).cross(q - b).dot(n) >= 0 &&
                      (a - c).cross(q - c).dot(n) >= 0;
  return inside ? std::min(best, (q - p).norm()) : best;
}

std::vector<Vector3d> points_around(unsigned seed, int count, double spread) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, spread);
  std::vector<Vector3d> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    points.emplace_back(normal(random), normal(random), normal(random));
  return points;
}

TEST(TriangleTree, NearestEqualsBruteForce) {
  const auto pose = arbitrary_pose(1);
  const TriMesh mesh = moved(test::joined(sphere(3, 10), cuboid({8, -3, -4}, {15, 20, 3})), pose);
  const TriangleTree tree(mesh);
  for (const auto& local : points_around(2, 500, 15)) {
    const Vector3d p = pose * local;
    double best = 1e9;
    for (const auto& t : mesh.triangles)
      best = std::min(best, distance_by_cases(mesh.vertices[t[0]], mesh.vertices[t[1]],
                                              mesh.vertices[t[2]], p));
    const SurfacePoint found = tree.nearest(p);
    ASSERT_NEAR(found.distance, best, 1e-11);
    ASSERT_GE(found.triangle, 0);
    const auto& t = mesh.triangles[found.triangle];
    const Vector3d q = found.barycentric[0] * mesh.vertices[t[0]] +
                       found.barycentric[1] * mesh.vertices[t[1]] +
                       found.barycentric[2] * mesh.vertices[t[2]];
    ASSERT_LT((q - found.point).norm(), 1e-12 * 100);
    ASSERT_NEAR((found.point - p).norm(), found.distance, 1e-11);
  }
}

// Bent, turned and shifted, and with a triangle that has lost its area.
TEST(TriangleTree, NearestIsRightWhenTheTrianglesHaveMoved) {
  TriMesh mesh = test::joined(sphere(3, 10), cuboid({8, -3, -4}, {15, 20, 3}));
  const TriangleTree before(mesh);
  const auto pose = arbitrary_pose(5);
  for (auto& v : mesh.vertices)
    v = pose * Vector3d(1.5 * v.x() + 0.02 * v.y() * v.y(), v.y(), v.z());
  mesh.vertices[static_cast<std::size_t>(mesh.triangles[7][1])] =
      mesh.vertices[static_cast<std::size_t>(mesh.triangles[7][0])];
  const TriangleTree tree = before.moved(mesh), fresh(mesh);
  for (const auto& local : points_around(6, 500, 15)) {
    const Vector3d p = pose * local;
    const SurfacePoint found = tree.nearest(p), expected = fresh.nearest(p);
    ASSERT_NEAR(found.distance, expected.distance, 1e-11);
    ASSERT_LT((found.point - p).norm() - found.distance, 1e-11);
    ASSERT_EQ(tree.nearest(p, 0.5 * expected.distance).triangle, -1);
  }
}

TEST(TriangleTree, ReachLimitsTheSearchAndChangesNoAnswerWithinIt) {
  const TriMesh mesh = sphere(3, 10);
  const TriangleTree tree(mesh);
  int within = 0, beyond = 0;
  for (const auto& p : points_around(3, 300, 10)) {
    const SurfacePoint all = tree.nearest(p), near = tree.nearest(p, 3.0);
    if (all.distance <= 3.0) {
      ++within;
      EXPECT_EQ(near.distance, all.distance);
      EXPECT_EQ(near.triangle, all.triangle);
    } else {
      ++beyond;
      EXPECT_EQ(near.triangle, -1);
    }
  }
  EXPECT_GT(within, 30);
  EXPECT_GT(beyond, 30);
  EXPECT_EQ(tree.nearest(mesh.vertices[5], 0.0).distance, 0.0);
}

TEST(TriangleTree, SignedDistanceOfABoxEqualsItsFormula) {
  const auto pose = arbitrary_pose(4);
  const Vector3d half(7, 4, 11);
  const TriangleTree tree(moved(cuboid(-half, half), pose));
  int inside = 0;
  for (const auto& p : points_around(5, 2000, 9)) {
    const Vector3d d = p.cwiseAbs() - half;
    const double expected = d.cwiseMax(0).norm() + std::min(d.maxCoeff(), 0.0);
    inside += expected < 0;
    ASSERT_NEAR(tree.signed_distance(pose * p), expected, 1e-10);
  }
  EXPECT_GT(inside, 100);
}

TEST(TriangleTree, SignIsRightBesideSharpEdgesAndCorners) {
  // A thin wedge: near its edge the sign of either face alone would be wrong on one side.
  TriMesh wedge;
  wedge.vertices = {{0, 0, -5},   {0, 0, 5},      {20, 0.5, -5},
                    {20, 0.5, 5}, {20, -0.5, -5}, {20, -0.5, 5}};
  wedge.triangles = {{0, 1, 3}, {0, 3, 2}, {0, 5, 1}, {0, 4, 5},
                     {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}};
  if (TriangleTree(wedge).winding_number({10, 0, 0}) < 0) flip(wedge);
  const TriangleTree tree(wedge);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> offset(-3, 3);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p(offset(random), offset(random), 2 * offset(random));
    const bool inside = p.x() > 0 && std::abs(p.y()) < p.x() / 40 && std::abs(p.z()) < 5;
    ASSERT_EQ(tree.signed_distance(p) < 0, inside) << p.transpose();
  }
}

TEST(TriangleTree, SignNeedsNoWeldedCorners) {
  const TriangleTree welded(cuboid({0, 0, 0}, {1, 1, 1})),
      soup(test::unwelded(cuboid({0, 0, 0}, {1, 1, 1})));
  for (const auto& p : points_around(7, 500, 1))
    EXPECT_EQ(welded.signed_distance(p), soup.signed_distance(p));
}

TEST(TriangleTree, WindingNumberCountsShellsAndAgreesWithTheSign) {
  const auto pose = arbitrary_pose(8);
  const TriMesh two = moved(test::joined(sphere(3, 10), sphere(3, 10, {8, 0, 0})), pose);
  const TriangleTree tree(two), one(moved(sphere(3, 10), pose)),
      other(moved(sphere(3, 10, {8, 0, 0}), pose));
  int inside_both = 0;
  for (const auto& local : points_around(9, 1000, 10)) {
    const Vector3d p = pose * local;
    const double a = one.signed_distance(p), b = other.signed_distance(p);
    if (std::min(std::abs(a), std::abs(b)) < 0.05) continue;
    const int expected = (a < 0) + (b < 0);
    inside_both += expected == 2;
    ASSERT_NEAR(tree.winding_number(p), expected, 0.02);
  }
  EXPECT_GT(inside_both, 50);
}

TEST(TriangleTree, WindingNumbersOfNeighboursAgreeWithThoseOfEach) {
  TriMesh open = sphere(4, 10);
  open.triangles.resize(open.triangles.size() * 3 / 4);
  const auto pose = arbitrary_pose(8);
  const TriangleTree tree(moved(open, pose));
  const auto centers = points_around(13, 200, 8);
  for (const double radius : {0.1, 1.0, 6.0}) {
    const auto shifts = points_around(14, 30, radius / 10);
    for (const Vector3d& c : centers) {
      const Vector3d center = pose * c;
      std::vector<Vector3d> points{center};
      double reach = 0;
      for (const Vector3d& shift : shifts) {
        points.push_back(center + shift);
        reach = std::max(reach, shift.norm());
      }
      std::vector<double> found(points.size());
      tree.winding_numbers(center, reach, points, found);
      for (std::size_t i = 0; i < points.size(); ++i)
        ASSERT_NEAR(found[i], tree.winding_number(points[i]), 0.02);
    }
  }
  std::vector<double> none(1, 7.0);
  TriangleTree(TriMesh{}).winding_numbers({0, 0, 0}, 1, std::vector<Vector3d>{{0, 0, 0}}, none);
  EXPECT_EQ(none[0], 0);
}

TEST(TriangleTree, RayHitsASphereWhereItsFormulaSays) {
  const TriangleTree tree(sphere(5, 10));
  int hits = 0;
  const auto points = points_around(10, 1000, 12);
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    const Vector3d o = points[i].normalized() * 30, d = points[i + 1] - o;
    const double b = o.dot(d) / d.squaredNorm(), c = (o.squaredNorm() - 100) / d.squaredNorm();
    const double root = b * b - c;
    const auto hit = tree.ray_cast(o, d);
    const double past = (o - b * d).norm();  // least distance of the ray from the centre
    if (past < 9.9) {
      ASSERT_TRUE(hit);
      ++hits;
      // The facets lie up to 0.01 mm inside; a grazing ray meets them later.
      ASSERT_NEAR(hit->distance * d.norm(), (-b - std::sqrt(root)) * d.norm(), 0.15);
      ASSERT_LT((o + hit->distance * d - hit->point).norm(), 1e-9);
      EXPECT_FALSE(tree.ray_cast(o, d, 0.99 * hit->distance));
    } else if (past > 10) {
      ASSERT_FALSE(hit);
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(TriangleTree, NoRaySlipsBetweenTriangles) {
  // Through every corner and the middle of every edge, from inside, along the axes as well.
  const TriMesh mesh = cuboid({-1, -2, -3}, {1, 2, 3});
  const TriangleTree tree(mesh);
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      for (const Vector3d& target :
           {mesh.vertices[t[k]],
            Vector3d(0.5 * (mesh.vertices[t[k]] + mesh.vertices[t[(k + 1) % 3]]))})
        EXPECT_TRUE(tree.ray_cast({0, 0, 0}, target)) << target.transpose();
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(tree.ray_cast({0, 0, 0}, Vector3d::Unit(k))->distance, k + 1, 1e-12);
    EXPECT_NEAR(tree.ray_cast({0, 0, 0}, -Vector3d::Unit(k))->distance, k + 1, 1e-12);
  }
}

TEST(TriangleTree, FlatTrianglesAndEmptyMeshesAreNoAnswer) {
  EXPECT_EQ(TriangleTree(TriMesh{}).nearest({0, 0, 0}).triangle, -1);
  EXPECT_FALSE(TriangleTree(TriMesh{}).ray_cast({0, 0, 0}, {1, 0, 0}));
  TriMesh mesh = sphere(1, 10);
  const int flat = static_cast<int>(mesh.triangles.size());
  mesh.triangles.emplace_back(0, 0, 1);
  const TriangleTree tree(mesh);
  for (const auto& p : points_around(11, 200, 10)) EXPECT_NE(tree.nearest(p).triangle, flat);
}

TEST(TriangleTree, ThreadsGetBitIdenticalResults) {
  const TriangleTree tree(sphere(4, 10));
  const auto points = points_around(12, 2000, 10);
  std::vector<double> one(points.size()), two(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) one[i] = tree.signed_distance(points[i]);
  const auto half = [&](std::size_t first) {
    for (std::size_t i = first; i < points.size(); i += 2) two[i] = tree.signed_distance(points[i]);
  };
  std::thread other(half, 1);
  half(0);
  other.join();
  EXPECT_EQ(one, two);
}

}  // namespace
}  // namespace condyle
