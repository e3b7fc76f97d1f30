#include "engine/tissue/remesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A fine patch of a cylinder of radius 60, 100 mm high, with a slit cut into it.
TriMesh patch_with_slit() {
  TriMesh mesh;
  constexpr int n = 81;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double angle = (i - 40) * 0.03;
      mesh.vertices.emplace_back(60 * std::sin(angle), -60 * std::cos(angle), (j - 40) * 1.25);
    }
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      if (j == 40 && i > 28 && i < 52) continue;  // one row of squares is missing
      const int a = j * n + i;
      mesh.triangles.emplace_back(a, a + 1, a + n + 1);
      mesh.triangles.emplace_back(a, a + n + 1, a + n);
    }
  return mesh;
}

TEST(Remesh, KeepsTopologyBordersPinsAndTheSurface) {
  const TriMesh fine = patch_with_slit();
  RemeshSettings settings;
  settings.edge_length = [](const Vector3d&) { return 8.0; };
  settings.pinned = {40 * 81 + 29, 40 * 81 + 52};
  const Remeshed coarse = remesh(fine, settings);
  const Topology before = inspect(fine), after = inspect(coarse.mesh);
  EXPECT_EQ(after.components, 1);
  EXPECT_EQ(after.nonmanifold_edges, 0);
  EXPECT_EQ(after.misoriented_edges, 0);
  ASSERT_EQ(after.boundary.size(), before.boundary.size());
  for (std::size_t i = 0; i < settings.pinned.size(); ++i)
    EXPECT_EQ(coarse.mesh.vertices[coarse.pinned[i]], fine.vertices[settings.pinned[i]]);
  for (const auto& v : coarse.mesh.vertices) EXPECT_NEAR(v.head<2>().norm(), 60, 0.1);
}

TEST(Remesh, GivesAboutTheRequestedEdgeLength) {
  RemeshSettings settings;
  settings.edge_length = [](const Vector3d&) { return 8.0; };
  const Remeshed coarse = remesh(patch_with_slit(), settings);
  double sum = 0;
  int count = 0;
  for (const auto& edge : find_edges(coarse.mesh).edges) {
    const double l = (coarse.mesh.vertices[edge.low] - coarse.mesh.vertices[edge.high]).norm();
    EXPECT_LT(l, 16);
    sum += l;
    ++count;
  }
  ASSERT_GT(count, 100);
  EXPECT_NEAR(sum / count, 8.0, 1.5);
}

}  // namespace
}  // namespace condyle
