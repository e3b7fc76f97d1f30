#include "sim/tissue/flattened_skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A square sheet with a pit in its middle, 1 mm between vertices.
TriMesh sheet_with_pit(int half, double radius, double depth) {
  TriMesh mesh;
  const int side = 2 * half + 1;
  for (int j = -half; j <= half; ++j)
    for (int i = -half; i <= half; ++i)
      mesh.vertices.emplace_back(i, j, std::hypot(i, j) < radius ? -depth : 0);
  for (int j = 0; j + 1 < side; ++j)
    for (int i = 0; i + 1 < side; ++i) {
      const int a = j * side + i;
      mesh.triangles.emplace_back(a, a + 1, a + side);
      mesh.triangles.emplace_back(a + 1, a + side + 1, a + side);
    }
  return mesh;
}

TEST(FlattenedSkin, APitBecomesAFlatMembrane) {
  constexpr double depth = 8;
  const TriMesh mesh = sheet_with_pit(20, 4, depth);
  const TriMesh flat = flattened_near(mesh, {Vector3d(0, 0, -depth)}, depth + 8);
  ASSERT_EQ(flat.triangles, mesh.triangles);
  for (std::size_t v = 0; v < flat.vertices.size(); ++v) {
    EXPECT_NEAR(flat.vertices[v].z(), 0, 1e-9);
    if (mesh.vertices[v].head<2>().norm() > 8 + 4) {
      EXPECT_EQ(flat.vertices[v], mesh.vertices[v]);
    }
  }
  for (const auto& t : flat.triangles) {  // no triangle is upside down
    const Vector3d a = flat.vertices[t[1]] - flat.vertices[t[0]];
    const Vector3d b = flat.vertices[t[2]] - flat.vertices[t[0]];
    EXPECT_GT(a.cross(b).z(), 0);
  }
}

// The reach is measured along the surface: the other side of a thin wall stays.
TEST(FlattenedSkin, WhatIsNearOnlyAcrossAPitStays) {
  constexpr double depth = 30;
  const TriMesh mesh = sheet_with_pit(12, 3, depth);
  const TriMesh flat = flattened_near(mesh, {Vector3d(5, 0, 0)}, 4);
  int in_pit = 0;
  for (std::size_t v = 0; v < flat.vertices.size(); ++v) {
    if (mesh.vertices[v].z() == 0) continue;
    ++in_pit;
    EXPECT_EQ(flat.vertices[v], mesh.vertices[v]);
  }
  EXPECT_GT(in_pit, 20);
}

TEST(FlattenedSkin, BordersStay) {
  constexpr int half = 6;
  TriMesh mesh = sheet_with_pit(half, 0, 0);
  for (auto& p : mesh.vertices) p.z() = std::sin(1.3 * p.x()) * std::cos(1.7 * p.y());
  const TriMesh flat = flattened_near(mesh, {Vector3d::Zero()}, 100);
  int moved = 0;
  for (std::size_t v = 0; v < flat.vertices.size(); ++v) {
    const bool stays = flat.vertices[v] == mesh.vertices[v];
    const double off = std::max(std::abs(mesh.vertices[v].x()), std::abs(mesh.vertices[v].y()));
    EXPECT_TRUE(stays || off < half);
    moved += !stays;
  }
  EXPECT_GT(moved, 100);
}

}  // namespace
}  // namespace condyle
