#include "engine/cut/cap_rims.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/cut/cell_complex.h"
#include "engine/mesh/measure.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

/// A tube along z, open at both ends, its wall facing out or in. The upper rim is bent by `slope`.
TriMesh tube(double radius, double height, bool outward, double slope = 0) {
  constexpr int count = 48;
  TriMesh mesh;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * std::numbers::pi * i / count;
    const Eigen::Vector3d p(radius * std::cos(a), radius * std::sin(a), 0);
    mesh.vertices.push_back(p);
    mesh.vertices.emplace_back(p.x(), p.y(), height + slope * p.x() * p.x());
  }
  for (int i = 0; i < count; ++i) {
    const int a = 2 * i, b = 2 * ((i + 1) % count);
    mesh.triangles.emplace_back(a, b, a + 1);
    mesh.triangles.emplace_back(b, b + 1, a + 1);
  }
  if (!outward)
    for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

double ring_area(double radius) {  // of the polygon of 48 corners
  return 24 * radius * radius * std::sin(2 * std::numbers::pi / 48);
}

TEST(CapFlatRims, RimsWithinOthersStayHolesOfTheCap) {
  // The shaft of a long bone with its marrow, and a rod beside it.
  TriMesh rod = tube(6, 30, true);
  for (auto& v : rod.vertices) v.x() += 40;
  TriMesh bone = test::joined(test::joined(tube(12, 30, true), tube(5, 30, false)), rod);
  const std::size_t vertices = bone.vertices.size();
  const CappedRims capped = cap_flat_rims(bone);
  EXPECT_EQ(capped.rims, 6);
  EXPECT_NEAR(capped.longest_rim_mm, 96 * 12 * std::sin(std::numbers::pi / 48), 1e-9);
  EXPECT_EQ(unbalanced_edges(bone), 0);
  EXPECT_EQ(bone.vertices.size(), vertices);
  EXPECT_NEAR(signed_volume(bone), 30 * (ring_area(12) - ring_area(5) + ring_area(6)), 1e-6);
}

TEST(CapFlatRims, ShortRimsAndBentOnesStayOpen) {
  TriMesh narrow = tube(4, 30, true);
  EXPECT_EQ(cap_flat_rims(narrow).rims, 0);
  EXPECT_EQ(unbalanced_edges(narrow), 96);
  TriMesh bent = tube(12, 30, true, 0.02);  // 2.9 mm high
  EXPECT_EQ(cap_flat_rims(bent).rims, 1);
  EXPECT_EQ(unbalanced_edges(bent), 48);
  TriMesh nearly = tube(12, 30, true, 0.003);  // 0.4 mm
  EXPECT_EQ(cap_flat_rims(nearly).rims, 2);
  EXPECT_EQ(unbalanced_edges(nearly), 0);
}

}  // namespace
}  // namespace condyle
