#include "engine/mesh/patches.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "tests/engine/mesh/shapes.h"

namespace condyle {
namespace {

std::vector<std::array<int, 3>> sorted(std::span<const Eigen::Vector3i> triangles) {
  std::vector<std::array<int, 3>> all;
  for (const auto& t : triangles) {
    // The corners may begin anywhere, but keep their sense.
    std::array<int, 3> corners = {t[0], t[1], t[2]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.push_back(corners);
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Patches, HoldEveryTriangleOnceAndStaySmall) {
  const TriMesh mesh = test::sphere(4, 40);
  std::vector<Eigen::Vector3f> positions;
  for (const auto& v : mesh.vertices) positions.push_back(v.cast<float>());
  const Patches patches = cut_into_patches(positions, mesh.triangles, 32);
  EXPECT_EQ(sorted(patches.triangles), sorted(mesh.triangles));
  ASSERT_EQ(patches.first.front(), 0);
  ASSERT_EQ(patches.first.back(), static_cast<int>(mesh.triangles.size()));
  Eigen::AlignedBox3f whole;
  for (const auto& p : positions) whole.extend(p);
  for (std::size_t k = 0; k + 1 < patches.first.size(); ++k) {
    EXPECT_GT(patches.first[k + 1], patches.first[k]);
    EXPECT_LE(patches.first[k + 1] - patches.first[k], 32);
    Eigen::AlignedBox3f box;
    for (int t = patches.first[k]; t < patches.first[k + 1]; ++t)
      for (const int v : patches.triangles[t]) box.extend(positions[v]);
    EXPECT_LT(box.diagonal().norm(), 0.7f * whole.diagonal().norm());
  }
}

TEST(Patches, OfNoTrianglesAreNone) {
  const Patches patches = cut_into_patches({}, {}, 64);
  EXPECT_TRUE(patches.triangles.empty());
  EXPECT_EQ(patches.first, std::vector<int>{0});
}

}  // namespace
}  // namespace condyle
