// Folded triangles are laid flat.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/mesh/unfold.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

/// A closed box of 20 x 20 x 4 mm with quads of 1 mm.
TriMesh plate() {
  TriMesh mesh;
  constexpr int n = 20;
  const auto id = [&](int layer, int i, int j) { return (layer * (n + 1) + j) * (n + 1) + i; };
  for (int layer = 0; layer < 2; ++layer)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(i, j, 4 * layer);
  const auto quad = [&](int a, int b, int c, int d) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      quad(id(1, i, j), id(1, i + 1, j), id(1, i + 1, j + 1), id(1, i, j + 1));
      quad(id(0, i, j + 1), id(0, i + 1, j + 1), id(0, i + 1, j), id(0, i, j));
    }
  for (int i = 0; i < n; ++i) {
    quad(id(0, i, 0), id(0, i + 1, 0), id(1, i + 1, 0), id(1, i, 0));
    quad(id(0, i + 1, n), id(0, i, n), id(1, i, n), id(1, i + 1, n));
    quad(id(0, 0, i + 1), id(0, 0, i), id(1, 0, i), id(1, 0, i + 1));
    quad(id(0, n, i), id(0, n, i + 1), id(1, n, i + 1), id(1, n, i));
  }
  return mesh;
}

TEST(Unfold, LeavesASurfaceWithoutFoldsAsItIs) {
  TriMesh mesh = plate();
  const TriMesh before = mesh;
  EXPECT_EQ(unfold(mesh), 0);
  EXPECT_EQ(mesh.vertices, before.vertices);
}

TEST(Unfold, LaysFoldsFlatSoThatTheInsideIsKnown) {
  TriMesh mesh = plate();
  ASSERT_TRUE(inspect(mesh).closed());
  // A corner is pulled over its neighbour.
  const auto pulled = static_cast<std::size_t>(1 * 21 * 21 + 10 * 21 + 10);
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
  TriMesh mesh = plate();
  const auto pulled = static_cast<std::size_t>(1 * 21 * 21 + 10 * 21 + 10);
  mesh.vertices[pulled].x() += 3;
  const TriMesh before = mesh;
  unfold(mesh, {.most_mm = 0.2});
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    EXPECT_LE((mesh.vertices[i] - before.vertices[i]).norm(), 0.2 + 1e-12);
}

}  // namespace
}  // namespace condyle::test
