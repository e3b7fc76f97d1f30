// Triangles that pass through others are found, and taken back.
#include "engine/mesh/self_crossings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/support/plate.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

/// Pushes a hill of the upper side through the lower one.
void push_through(TriMesh& mesh, double depth_mm) {
  for (int j = 0; j <= plate_cells; ++j)
    for (int i = 0; i <= plate_cells; ++i)
      mesh.vertices[static_cast<std::size_t>(plate_vertex(1, i, j))].z() -=
          depth_mm * std::exp(-(std::pow(i - 10.3, 2) + std::pow(j - 9.6, 2)) / 8);
}

TEST(SelfCrossings, ASoundOrTouchingSurfaceHasNone) {
  TriMesh mesh = plate(1);
  ASSERT_TRUE(inspect(mesh).closed());
  EXPECT_TRUE(self_crossings(mesh).empty());
  mesh.vertices[static_cast<std::size_t>(plate_vertex(1, 10, 10))].z() = 0;  // a corner on a corner
  EXPECT_TRUE(self_crossings(mesh).empty());
}

TEST(SelfCrossings, AreFoundWithTheSameResultOnAnyNumberOfThreads) {
  TriMesh mesh = plate(1);
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
  const TriMesh before = plate(1);
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
  const auto aside = static_cast<std::size_t>(plate_vertex(1, 13, 13));
  EXPECT_GT((pushed.vertices[aside] - before.vertices[aside]).norm(), 0.1);
  EXPECT_EQ(mesh.vertices[aside], pushed.vertices[aside]);
}

}  // namespace
}  // namespace condyle::test
