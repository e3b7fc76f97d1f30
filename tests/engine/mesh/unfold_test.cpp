// Folded triangles are laid flat.
#include "engine/mesh/unfold.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/support/plate.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

TEST(Unfold, LeavesASurfaceWithoutFoldsAsItIs) {
  TriMesh mesh = plate(4);
  const TriMesh before = mesh;
  EXPECT_EQ(unfold(mesh), 0);
  EXPECT_EQ(mesh.vertices, before.vertices);
}

TEST(Unfold, LaysFoldsFlatSoThatTheInsideIsKnown) {
  TriMesh mesh = plate(4);
  ASSERT_TRUE(inspect(mesh).closed());
  // A corner is pulled over its neighbour.
  const auto pulled = static_cast<std::size_t>(plate_vertex(1, 10, 10));
  mesh.vertices[pulled] += Vector3d(1.4, 0.1, 0);
  TriMesh folded = mesh;
  EXPECT_GT(unfold(folded, {.rounds = 0}), 0);
  const auto wrong = [](const TriMesh& of) {
    const TriangleTree tree(of);
    int count = 0;
    for (double x = 9; x < 13; x += 0.1)
      for (double y = 9; y < 12; y += 0.1)
        count += tree.signed_distance({x, y, 4.2}) < 0 || tree.signed_distance({x, y, 3.8}) > 0;
    return count;
  };
  EXPECT_GT(wrong(mesh), 0) << "the fold turns inside and outside round";
  EXPECT_EQ(unfold(mesh, {.most_mm = 2}), 0);
  EXPECT_EQ(wrong(mesh), 0);
  EXPECT_TRUE(inspect(mesh).closed());
}

TEST(Unfold, MovesNoVertexFarther) {
  TriMesh mesh = plate(4);
  const auto pulled = static_cast<std::size_t>(plate_vertex(1, 10, 10));
  mesh.vertices[pulled].x() += 3;
  const TriMesh before = mesh;
  unfold(mesh, {.most_mm = 0.2});
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    EXPECT_LE((mesh.vertices[i] - before.vertices[i]).norm(), 0.2 + 1e-12);
}

}  // namespace
}  // namespace condyle::test
