#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "engine/cut/cut.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"

namespace condyle::test {

/// Fans of triangles at the vertices less the number of used vertices: 0 on a manifold.
inline int surplus_fans(const TriMesh& mesh) {
  std::vector<std::vector<int>> at(mesh.vertices.size());
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    for (const int v : mesh.triangles[t]) at[v].push_back(t);
  int surplus = 0;
  for (int v = 0; v < static_cast<int>(at.size()); ++v) {
    if (at[v].empty()) continue;
    std::set<int> left(at[v].begin(), at[v].end());
    int fans = 0;
    while (!left.empty()) {
      ++fans;
      std::vector<int> stack{*left.begin()};
      left.erase(left.begin());
      while (!stack.empty()) {
        const auto here = mesh.triangles[stack.back()];
        stack.pop_back();
        for (auto other = left.begin(); other != left.end();) {
          int shared = 0;
          for (const int a : here)
            for (const int b : mesh.triangles[*other]) shared += a == b && a != v;
          if (shared) {
            stack.push_back(*other);
            other = left.erase(other);
          } else {
            ++other;
          }
        }
      }
    }
    surplus += fans - 1;
  }
  return surplus;
}

/// Every piece is closed and manifold, names the origin of its faces, and the volumes add up.
inline void expect_whole(const TriMesh& bone, const CutResult& result) {
  double sum = result.kerf_volume_mm3;
  for (std::size_t i = 0; i < result.pieces.size(); ++i) {
    const Piece& piece = result.pieces[i];
    const Topology topology = inspect(piece.mesh);
    EXPECT_EQ(topology.boundary_edges, 0) << "piece " << i;
    EXPECT_EQ(topology.nonmanifold_edges, 0) << "piece " << i;
    EXPECT_EQ(topology.misoriented_edges, 0) << "piece " << i;
    EXPECT_EQ(surplus_fans(piece.mesh), 0) << "piece " << i;
    ASSERT_EQ(piece.source.size(), piece.mesh.triangles.size());
    ASSERT_EQ(piece.wall.size(), piece.mesh.triangles.size());
    for (std::size_t t = 0; t < piece.source.size(); ++t)
      ASSERT_NE(piece.source[t] >= 0, piece.wall[t] >= 0) << "piece " << i << ", face " << t;
    EXPECT_NEAR(piece.volume_mm3, signed_volume(piece.mesh), 1e-9 * std::abs(piece.volume_mm3));
    sum += piece.volume_mm3;
  }
  const double whole = signed_volume(bone);
  EXPECT_NEAR(sum, whole, 1e-6 * whole);
}

}  // namespace condyle::test
