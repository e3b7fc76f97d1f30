#include "engine/mesh/slit_seam.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int around = 120, deep = 40, outside = 20;
constexpr double half_width = 25, half_height = 1.5;

/// A wall facing -y with a slit in it, behind which a tube extends 20 mm back and widens, so that
/// the wall hides it; its last ring is the rim.
TriMesh wall_with_tube(std::vector<int>& rim) {
  TriMesh mesh;
  for (int ring = 0; ring <= outside + deep; ++ring)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      const double out = std::max(0, outside - ring), in = 0.5 * std::max(0, ring - outside);
      const double wider = out + 0.3 * in;
      mesh.vertices.emplace_back((half_width + wider) * std::cos(angle), in,
                                 (half_height + wider) * std::sin(angle));
    }
  const auto at = [](int ring, int i) { return ring * around + i % around; };
  for (int ring = 0; ring < outside + deep; ++ring)
    for (int i = 0; i < around; ++i) {
      mesh.triangles.emplace_back(at(ring, i), at(ring, i + 1), at(ring + 1, i + 1));
      mesh.triangles.emplace_back(at(ring, i), at(ring + 1, i + 1), at(ring + 1, i));
    }
  for (int i = 0; i < around; ++i) rim.push_back(at(outside + deep, i));
  return mesh;
}

TEST(SlitSeam, IsNarrowAtTheEndsAndBroadAtTheSides) {
  std::vector<int> rim;
  const TriMesh face = wall_with_tube(rim);
  const auto kept = without_deep_inside(face, rim, Vector3d::Zero(), 60);
  double corner = 0, lip = 0;
  for (const auto& t : kept)
    for (const int v : t) {
      const Vector3d& p = face.vertices[static_cast<std::size_t>(v)];
      if (std::abs(p.x()) > half_width) corner = std::max(corner, p.y());
      if (std::abs(p.x()) < 3) lip = std::max(lip, p.y());
    }
  EXPECT_GT(corner, 0.5);
  EXPECT_LT(corner, 2);
  EXPECT_GT(lip, 11);
  EXPECT_LT(lip, 17);
}

TEST(SlitSeam, WhatStaysIsASurfaceWithOneRimThere) {
  std::vector<int> rim;
  const TriMesh face = wall_with_tube(rim);
  const TriMesh kept{face.vertices, without_deep_inside(face, rim, Vector3d::Zero(), 60), {}};
  ASSERT_LT(kept.triangles.size(), face.triangles.size() - 500);
  const Topology topology = inspect(kept);
  EXPECT_EQ(topology.boundary.size(), 2u);  // the wall's own, and the rim
  EXPECT_EQ(topology.nonmanifold_edges, 0);
  EXPECT_EQ(find_components(kept).count, 1);
}

TEST(SlitSeam, WhatIsSeenFromTheFrontStays) {
  std::vector<int> rim;
  TriMesh face = wall_with_tube(rim);
  face.triangles.resize(std::size_t{2} * around * outside);  // the wall alone
  rim.clear();
  for (int i = 0; i < around; ++i) rim.push_back(outside * around + i);
  EXPECT_EQ(without_deep_inside(face, rim, Vector3d::Zero(), 60), face.triangles);
}

}  // namespace
}  // namespace condyle
