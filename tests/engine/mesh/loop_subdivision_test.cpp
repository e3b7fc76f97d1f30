#include "engine/mesh/loop_subdivision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh/rims.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

/// A plane of n x n squares, each cut in two.
TriMesh sheet(int n) {
  TriMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(i, 0.5 * j, 0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
    }
  return mesh;
}

std::vector<Vector3f> places(const TriMesh& mesh) {
  std::vector<Vector3f> result;
  for (const auto& v : mesh.vertices) result.push_back(v.cast<float>());
  return result;
}

TriMesh divided(const TriMesh& mesh) {
  const auto finer = subdivide(static_cast<int>(mesh.vertices.size()), mesh.triangles);
  TriMesh result;
  for (const auto& p : finer.vertices.of<Vector3f>(places(mesh)))
    result.vertices.push_back(p.cast<double>());
  result.triangles = finer.triangles;
  return result;
}

TEST(LoopSubdivision, SplitsATriangleInFourAndKeepsNeighboursWindingAndRim) {
  TriMesh mesh = sheet(6);
  mesh.triangles.erase(mesh.triangles.begin() + 28, mesh.triangles.begin() + 30);  // a hole
  const auto before = inspect(mesh), after = inspect(divided(mesh));
  EXPECT_EQ(divided(mesh).triangles.size(), 4 * mesh.triangles.size());
  EXPECT_EQ(after.boundary_edges, 2 * before.boundary_edges);
  EXPECT_EQ(after.boundary.size(), before.boundary.size());
  EXPECT_EQ(after.misoriented_edges, 0);
  EXPECT_EQ(after.nonmanifold_edges, 0);
  EXPECT_EQ(rims_of(divided(mesh)).size(), 2u);
}

TEST(LoopSubdivision, WeightsSumToOneSoThatRigidMotionIsPreserved) {
  const TriMesh mesh = sheet(4);
  const auto finer = subdivide(static_cast<int>(mesh.vertices.size()), mesh.triangles);
  const auto twice = composed(
      subdivide(static_cast<int>(finer.vertices.size()), finer.triangles).vertices, finer.vertices);
  ASSERT_GT(twice.size(), 2 * finer.vertices.size());
  for (const float one : twice.of<float>(std::vector<float>(mesh.vertices.size(), 1.f)))
    EXPECT_NEAR(one, 1, 1e-5f);
  // A plane stays one, also when it is tilted.
  auto tilted = places(mesh);
  for (auto& p : tilted) p.z() = 2 * p.x() - 3 * p.y() + 1;
  for (const auto& p : twice.of<Vector3f>(tilted))
    EXPECT_NEAR(p.z(), 2 * p.x() - 3 * p.y() + 1, 1e-4f);
}

TEST(LoopSubdivision, ComposedWeightsEqualSuccessiveSubdivisions) {
  TriMesh mesh = sheet(3);
  for (auto& v : mesh.vertices) v.z() = std::sin(3 * v.x() + v.y());
  const auto first = subdivide(static_cast<int>(mesh.vertices.size()), mesh.triangles);
  const auto second = subdivide(static_cast<int>(first.vertices.size()), first.triangles);
  const auto at_once = composed(second.vertices, first.vertices).of<Vector3f>(places(mesh));
  const auto in_turn = second.vertices.of<Vector3f>(first.vertices.of<Vector3f>(places(mesh)));
  ASSERT_EQ(at_once.size(), in_turn.size());
  for (std::size_t v = 0; v < at_once.size(); ++v)
    EXPECT_NEAR((at_once[v] - in_turn[v]).norm(), 0, 1e-5f);
}

TEST(LoopSubdivision, TurnsLessFromTriangleToTriangleThanWhatItDivides) {
  // An octahedron: a sphere of the fewest triangles.
  TriMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const auto sharpest = [](const TriMesh& surface) {
    const auto normal = [&](int t) {
      const auto& c = surface.triangles[static_cast<std::size_t>(t)];
      const auto& v = surface.vertices;
      return (v[static_cast<std::size_t>(c[1])] - v[static_cast<std::size_t>(c[0])])
          .cross(v[static_cast<std::size_t>(c[2])] - v[static_cast<std::size_t>(c[0])])
          .normalized()
          .eval();
    };
    const auto list = find_edges(surface);
    double least = 1;
    for (const auto& edge : list.edges)
      least = std::min(
          least, normal(list.sides[static_cast<std::size_t>(edge.first)].triangle)
                     .dot(normal(list.sides[static_cast<std::size_t>(edge.first) + 1].triangle)));
    return std::acos(least);
  };
  const TriMesh once = divided(mesh), twice = divided(once);
  EXPECT_TRUE(inspect(twice).closed());
  EXPECT_GT(inspect(twice).volume_mm3, 0);
  EXPECT_LT(sharpest(once), 0.8 * sharpest(mesh));
  EXPECT_LT(sharpest(twice), 0.8 * sharpest(once));
}

}  // namespace
}  // namespace condyle
