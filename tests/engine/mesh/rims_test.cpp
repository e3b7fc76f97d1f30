#include "engine/mesh/rims.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace condyle {
namespace {

/// A plane of n x n squares, each cut in two, but those left out: (column, row).
TriMesh plane_without(int n, const std::vector<std::pair<int, int>>& squares) {
  TriMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(i, j, 0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (std::find(squares.begin(), squares.end(), std::pair(i, j)) != squares.end()) continue;
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
    }
  return mesh;
}

std::vector<std::size_t> sizes(const TriMesh& mesh) {
  std::vector<std::size_t> found;
  for (const auto& rim : rims_of(mesh)) found.push_back(rim.size());
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Rims, AreOneForEachHoleAndTheEdgeAndRunAsMissingTrianglesWould) {
  const TriMesh mesh = plane_without(6, {{2, 3}});
  EXPECT_EQ(sizes(mesh), (std::vector<std::size_t>{4, 24}));
  for (const auto& rim : rims_of(mesh)) {
    double area = 0;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const auto& a = mesh.vertices[static_cast<std::size_t>(rim[i])];
      const auto& b = mesh.vertices[static_cast<std::size_t>(rim[(i + 1) % rim.size()])];
      area += (a.x() * b.y() - a.y() * b.x()) / 2;
    }
    EXPECT_EQ(area, rim.size() == 4 ? 1 : -36);
  }
}

TEST(Rims, OfHolesThatShareAVertexAreSeparated) {
  EXPECT_EQ(sizes(plane_without(6, {{2, 2}, {3, 3}})), (std::vector<std::size_t>{4, 4, 24}));
  EXPECT_EQ(sizes(plane_without(6, {{3, 2}, {2, 3}})), (std::vector<std::size_t>{4, 4, 24}));
  EXPECT_EQ(sizes(plane_without(6, {{1, 1}, {2, 2}, {3, 3}})),
            (std::vector<std::size_t>{4, 4, 4, 24}));
}

}  // namespace
}  // namespace condyle
