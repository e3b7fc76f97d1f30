#include "sim/tissue/lip_pocket.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/mesh/slit_seam.h"
#include "engine/mesh/topology.h"
#include "sim/tissue/lips.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A wall facing the front (-y), 80 x 40 mm, indented along its middle to a pocket of `depth` mm
/// between x = -25 and 25 whose walls touch except for `gap`.
TriMesh wall(double depth, double gap) {
  constexpr int columns = 80, rows = 40;
  TriMesh mesh;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double x = i - 40.0, z = j - 20.0;
      const double across = std::clamp(1 - std::abs(z) / 10, 0.0, 1.0);
      const double along = std::sqrt(std::max(0.0, 1 - x * x / 625));
      const double in = across * along;
      mesh.vertices.emplace_back(x, depth * in,
                                 z * (1 - in) + gap *
                                                    (z > 0   ? 1
                                                     : z < 0 ? -1
                                                             : 0) *
                                                    in);
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, b = a + 1, d = a + columns + 1, c = d + 1;
      mesh.triangles.emplace_back(a, b, c);
      mesh.triangles.emplace_back(a, c, d);
    }
  return mesh;
}

const LipLine line{{-25, 0, 0}, {0, 0, 0}, {25, 0, 0}};

TEST(LipPocket, ItsBottomIsFoundFromCornerToCorner) {
  const TriMesh face = wall(14, 0.2);
  const auto run = pocket_bottom(face, line);
  ASSERT_GT(run.size(), 30u);
  EXPECT_LT((face.vertices[run.front()] - line.right).norm(), 0.5);
  EXPECT_LT((face.vertices[run.back()] - line.left).norm(), 0.5);
  for (int v : run) {
    const Vector3d& p = face.vertices[v];
    EXPECT_GT(p.y(), 13.5 * std::sqrt(std::max(0.0, 1 - p.x() * p.x() / 625)) - 1);
  }
}

// As the inner side of a thick skin: it is connected to the front only far away.
TEST(LipPocket, AWallBehindTheFaceIsNoPocket) {
  TriMesh face = wall(3, 0.2);
  const TriMesh front = face;
  const int count = static_cast<int>(front.vertices.size());
  for (const auto& v : front.vertices) face.vertices.push_back(v + Vector3d(0, 12, 0));
  for (const auto& t : front.triangles)
    face.triangles.emplace_back(t[0] + count, t[2] + count, t[1] + count);
  EXPECT_TRUE(pocket_bottom(face, line).empty());
}

/// A wall with a pocket whose bottom is missing in the middle, from this depth on.
TriMesh wall_with_hole(double from_mm) {
  TriMesh face = wall(14, 0.2);
  std::erase_if(face.triangles, [&](const Eigen::Vector3i& t) {
    const Vector3d p = (face.vertices[t[0]] + face.vertices[t[1]] + face.vertices[t[2]]) / 3;
    return std::abs(p.x()) < 3 && p.y() > from_mm;
  });
  return face;
}

TEST(LipPocket, PathsGoAroundAHoleOrAreRefused) {
  TriMesh face = wall_with_hole(13);
  const std::size_t loops = border_loops(face).size();
  const auto run = pocket_bottom(face, line);
  ASSERT_FALSE(run.empty());
  cut_along(run, face);
  EXPECT_EQ(border_loops(face).size(), loops + 1);
  EXPECT_TRUE(pocket_bottom(wall_with_hole(5), line).empty());  // the remainder is not deep
}

/// A wall with a slit between lips 3 mm thick, and behind them an oral cavity, closed behind.
TriMesh wall_with_mouth(double height_mm = 30, int depth_mm = 30) {
  constexpr int around = 96, outside = 30;
  const int deep = 2 * depth_mm;
  TriMesh mesh;
  for (int ring = 0; ring <= outside + deep; ++ring)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around,
                   in = 0.5 * std::max(0, ring - outside);
      const double wider =
          std::max(0, outside - ring) + std::clamp(2 * (in - 3), 0.0, 0.5 * height_mm);
      mesh.vertices.emplace_back((22 + wider) * std::cos(angle), in,
                                 (0.05 + wider) * std::sin(angle));
    }
  const auto at = [](int ring, int i) { return ring * around + i % around; };
  for (int ring = 0; ring < outside + deep; ++ring)
    for (int i = 0; i < around; ++i) {
      mesh.triangles.emplace_back(at(ring, i), at(ring, i + 1), at(ring + 1, i + 1));
      mesh.triangles.emplace_back(at(ring, i), at(ring + 1, i + 1), at(ring + 1, i));
    }
  for (int i = 1; i + 1 < around; ++i)
    mesh.triangles.emplace_back(at(outside + deep, 0), at(outside + deep, i),
                                at(outside + deep, i + 1));
  return mesh;
}

TEST(LipPocket, AMouthBehindTheLipsIsOpenedAtItsOwnCorners) {
  TriMesh face = wall_with_mouth();
  ASSERT_EQ(border_loops(face).size(), 1u);
  const int deep = static_cast<int>(face.vertices.size()) - 1;
  ASSERT_TRUE(open_pouch(face, line, {deep}));
  const auto loops = border_loops(face);
  ASSERT_EQ(loops.size(), 2u);
  const auto& mouth = face.vertices[loops[0][0]].y() > 0 ? loops[0] : loops[1];
  double right = 0, left = 0, back = 0;
  for (int v : mouth) {
    right = std::min(right, face.vertices[v].x());
    left = std::max(left, face.vertices[v].x());
    back = std::max(back, face.vertices[v].y());
  }
  EXPECT_NEAR(right, -22, 1.5);  // and not the line's 25
  EXPECT_NEAR(left, 22, 1.5);
  EXPECT_LT(back, 16);
}

TEST(LipPocket, AGapBetweenLipsOrATunnelThroughTheHeadIsNoMouth) {
  for (TriMesh face : {wall_with_mouth(5), wall_with_mouth(30, 120)}) {
    const auto whole = face.triangles;
    const std::vector<int> deep = {static_cast<int>(face.vertices.size()) - 1};
    EXPECT_LT(without_deep_inside(face, deep, line.middle, 70, {}).size(), whole.size());
    EXPECT_FALSE(open_pouch(face, line, deep));
    EXPECT_EQ(face.triangles, whole);
  }
}

TEST(LipPocket, AFaceWithoutAPocketHasNone) {
  EXPECT_TRUE(pocket_bottom(wall(0, 0), line).empty());
  EXPECT_TRUE(pocket_bottom(wall(3, 0.2), line).empty());
}

TEST(LipPocket, ACutAlongAChainOfEdgesOpensOnlyThatChain) {
  TriMesh face = wall(14, 0.2);
  face.colors.assign(face.vertices.size(), Eigen::Vector3f(0.5f, 0.2f, 0.1f));
  const TriMesh whole = face;
  const auto run = pocket_bottom(face, line);
  cut_along(run, face);
  EXPECT_EQ(face.vertices.size(), whole.vertices.size() + run.size() - 2);
  EXPECT_EQ(face.colors.size(), face.vertices.size());
  ASSERT_EQ(face.triangles.size(), whole.triangles.size());
  for (std::size_t t = 0; t < face.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(face.vertices[face.triangles[t][k]], whole.vertices[whole.triangles[t][k]]);
  auto loops = border_loops(face);
  ASSERT_EQ(loops.size(), 2u);  // the wall's own, and the cut
  const auto& cut = loops[0].size() < loops[1].size() ? loops[0] : loops[1];
  EXPECT_EQ(cut.size(), 2 * (run.size() - 1));
  // Duplicates belong to the triangles right of the chain: below it, viewed from the front.
  for (std::size_t t = 0; t < face.triangles.size(); ++t)
    for (int v : face.triangles[t])
      if (v >= static_cast<int>(whole.vertices.size())) {
        double z = 0;
        for (int corner : face.triangles[t]) z += face.vertices[corner].z();
        EXPECT_LT(z, 1e-9);
      }
}

}  // namespace
}  // namespace condyle
