#include "engine/field/wrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

/// Without the triangles whose first corner lies above z.
TriMesh open_above(TriMesh mesh, double z) {
  std::erase_if(mesh.triangles,
                [&](const Eigen::Vector3i& t) { return mesh.vertices[t[0]].z() > z; });
  return mesh;
}

TEST(Wrap, ClosesAnOpeningAndKeepsTheRest) {
  const TriMesh open = open_above(test::sphere(5, 20), 14);
  const WrappedSurface wrapped = wrap(open);
  EXPECT_TRUE(inspect(wrapped.mesh).closed());
  EXPECT_EQ(wrapped.solids, 1);
  EXPECT_NEAR(wrapped.spacing_mm, 0.4, 0.07);
  EXPECT_LT(wrapped.largest_mm, wrapped.spacing_mm);  // at the rim
  EXPECT_LT(wrapped.mean_mm, 0.05);
  // A flat opening fills half of the view from each of its points: the lid is flat. The rim is
  // jagged by the length of an edge, 1.3 mm.
  const double h = 6, cap = std::numbers::pi * h * h * (20 - h / 3),
               ball = 4.0 / 3 * std::numbers::pi * 8000;
  EXPECT_NEAR(signed_volume(wrapped.mesh), ball - cap, 0.01 * ball);
  EXPECT_GT(wrapped.opening_mm, 4);
}

TEST(Wrap, WallsWithinOverlappingShellsVanish) {
  const TriMesh two = test::joined(test::sphere(4, 12), test::sphere(4, 12, {10, 1, 2}));
  const WrappedSurface wrapped = wrap(two);
  const Topology topology = inspect(wrapped.mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1);
  EXPECT_LT(wrapped.largest_mm, 0.3);
  // Two balls less the lens that they share.
  const double r = 12, d = std::sqrt(105.0);
  const double lens = std::numbers::pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12;
  const double expected = 8.0 / 3 * std::numbers::pi * r * r * r - lens;
  EXPECT_NEAR(topology.volume_mm3, expected, 0.01 * expected);
}

TEST(Wrap, ASheetBecomesAPlateOfTheLeastThickness) {
  TriMesh sheet;
  constexpr int count = 40;
  for (int i = 0; i <= count; ++i)
    for (int j = 0; j <= count; ++j) sheet.vertices.emplace_back(i, j, 0.004 * (i - 20) * (j - 20));
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) {
      const int v = i * (count + 1) + j, w = v + count + 1;
      sheet.triangles.emplace_back(v, w, w + 1);
      sheet.triangles.emplace_back(v, w + 1, v + 1);
    }
  const WrappedSurface wrapped = wrap(sheet);
  EXPECT_TRUE(inspect(wrapped.mesh).closed());
  EXPECT_EQ(wrapped.solids, 1);
  EXPECT_NEAR(wrapped.largest_mm, 0.75 * wrapped.spacing_mm, 0.25 * wrapped.spacing_mm);
  const double plate = 1.5 * wrapped.spacing_mm * surface_area(sheet);
  EXPECT_NEAR(signed_volume(wrapped.mesh), plate, 0.1 * plate);
}

TEST(Wrap, APlateThinnerThanTheGridHasNoHoles) {
  // A shell 0.1 mm thick around a cavity.
  TriMesh inner = test::sphere(5, 19.9, {0.1, 0.2, 0.3});
  for (auto& t : inner.triangles) std::swap(t[0], t[1]);
  const WrappedSurface wrapped =
      wrap(test::joined(test::sphere(5, 20, {0.1, 0.2, 0.3}), inner), {.spacing_mm = 0.4});
  const Topology topology = inspect(wrapped.mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 2) << "outside and inside";
  EXPECT_EQ(wrapped.solids, 1);
  EXPECT_LT(wrapped.largest_mm, wrapped.spacing_mm);
}

TEST(Wrap, DependsOnNoNumberOfThreads) {
  const TriMesh open = open_above(test::sphere(4, 15, {1, 2, 3}, 0.1), 12);
  const auto one = wrap(open, {.threads = 1}), three = wrap(open, {.threads = 3});
  EXPECT_EQ(mesh_hash(one.mesh), mesh_hash(three.mesh));
  EXPECT_EQ(one.largest_mm, three.largest_mm);
  EXPECT_EQ(one.mean_mm, three.mean_mm);
}

TEST(Wrap, NothingEnclosesNothing) {
  EXPECT_TRUE(wrap({}).mesh.empty());
  EXPECT_EQ(wrap({}).solids, 0);
}

}  // namespace
}  // namespace condyle
