// Triangles that pass through others are found, and taken back.
#include "engine/mesh/self_crossings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

constexpr int cells = 20;
constexpr double thickness_mm = 1;

int plate_vertex(int layer, int i, int j) { return (layer * (cells + 1) + j) * (cells + 1) + i; }

/// A closed box of 20 x 20 x 1 mm with quads of 1 mm.
TriMesh thin_plate() {
  TriMesh mesh;
  for (int layer = 0; layer < 2; ++layer)
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) mesh.vertices.emplace_back(i, j, layer * thickness_mm);
  const auto quad = [&](int a, int b, int c, int d) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
  };
  const auto at = plate_vertex;
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      quad(at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1));
      quad(at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j), at(0, i, j));
    }
  for (int i = 0; i < cells; ++i) {
    quad(at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0));
    quad(at(0, i + 1, cells), at(0, i, cells), at(1, i, cells), at(1, i + 1, cells));
    quad(at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1));
    quad(at(0, cells, i), at(0, cells, i + 1), at(1, cells, i + 1), at(1, cells, i));
  }
  return mesh;
}

/// Pushes a hill of the upper side through the lower one.
void push_through(TriMesh& mesh, double depth_mm) {
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i)
      mesh.vertices[static_cast<std::size_t>(plate_vertex(1, i, j))].z() -=
          depth_mm * std::exp(-(std::pow(i - 10.3, 2) + std::pow(j - 9.6, 2)) / 8);
}

TEST(SelfCrossings, ASoundOrTouchingSurfaceHasNone) {
  TriMesh mesh = thin_plate();
  ASSERT_TRUE(inspect(mesh).closed());
  EXPECT_TRUE(self_crossings(mesh).empty());
  mesh.vertices[static_cast<std::size_t>(plate_vertex(1, 10, 10))].z() = 0;  // a corner on a corner
  EXPECT_TRUE(self_crossings(mesh).empty());
}

TEST(SelfCrossings, AreFoundWithTheSameResultOnAnyNumberOfThreads) {
  TriMesh mesh = thin_plate();
  push_through(mesh, 1.6);
  const std::vector<int> found = self_crossings(mesh);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found, self_crossings(mesh, 2));
  for (const int t : found) {
    const Vector3d at =
        mesh.vertices[static_cast<std::size_t>(mesh.triangles[static_cast<std::size_t>(t)][0])];
    EXPECT_LT((at.head<2>() - Eigen::Vector2d(10.3, 9.6)).norm(), 5);
  }
}

TEST(SelfCrossings, AreTakenBackSoThatTheOutsideIsKnown) {
  const TriMesh before = thin_plate();
  TriMesh mesh = before;
  push_through(mesh, 1.6);
  // Just below the hill that came through, the surface is inside out.
  const Vector3d below(10.3, 9.6, -1);
  EXPECT_LT(TriangleTree(mesh).signed_distance(below), 0);
  EXPECT_EQ(uncross(mesh, before.vertices), 0u);
  EXPECT_TRUE(self_crossings(mesh).empty());
  EXPECT_GT(TriangleTree(mesh).signed_distance(below), 0);
  // What crosses nothing keeps its move.
  TriMesh pushed = before;
  push_through(pushed, 1.6);
  const auto aside = static_cast<std::size_t>(plate_vertex(1, 3, 3));
  EXPECT_NE(pushed.vertices[aside], before.vertices[aside]);
  EXPECT_EQ(mesh.vertices[aside], pushed.vertices[aside]);
}

}  // namespace
}  // namespace condyle::test
