#include "engine/mesh/holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "tests/engine/mesh/shapes.h"

namespace condyle {
namespace {

using test::arbitrary_pose;
using test::moved;
using test::sphere;

/// The mesh without those triangles that `out` says.
template <class Out>
TriMesh without(TriMesh mesh, const Out& out) {
  int index = 0;
  std::erase_if(mesh.triangles, [&](const Eigen::Vector3i&) { return out(index++); });
  return mesh;
}

TEST(Holes, SingleMissingTrianglesComeBack) {
  const TriMesh whole = moved(sphere(3, 10), arbitrary_pose(4));
  TriMesh holed = without(whole, [](int i) { return i % 50 == 0; });
  const auto missing = whole.triangles.size() - holed.triangles.size();
  EXPECT_EQ(close_small_holes(holed).holes, static_cast<int>(missing));
  EXPECT_TRUE(inspect(holed).closed());
  EXPECT_NEAR(signed_volume(holed), signed_volume(whole), 1e-9);
}

TEST(Holes, ManyOfAnyShapeAreClosedAndTheSurfaceStaysWhereItWas) {
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    const TriMesh whole = moved(sphere(4, 30), arbitrary_pose(round));
    TriMesh holed = without(whole, [&](int) { return random() % 100 < 8; });
    drop_unreferenced(holed);
    close_small_holes(holed, {.rim_mm = 30});
    const Topology found = inspect(holed);
    EXPECT_EQ(found.nonmanifold_edges, 0);
    EXPECT_EQ(found.misoriented_edges, 0);
    EXPECT_TRUE(found.closed()) << found.boundary_edges;
    EXPECT_NEAR(signed_volume(holed), signed_volume(whole), 2e-3 * signed_volume(whole));
  }
}

TEST(Holes, LongRimsStayOpen) {
  const TriMesh whole = sphere(3, 10);
  const TriMesh bowl =
      without(whole, [&](int i) { return whole.vertices[whole.triangles[i][0]].z() > 0; });
  TriMesh same = bowl;
  EXPECT_EQ(close_small_holes(same).holes, 0);
  EXPECT_EQ(same.triangles.size(), bowl.triangles.size());
}

TEST(Holes, OfFewEdgesMayBeWider) {
  const TriMesh whole = sphere(1, 20);  // 80 triangles with edges of 11 to 13 mm
  TriMesh holed = without(whole, [](int i) { return i == 40; });
  TriMesh same = holed;
  EXPECT_EQ(close_small_holes(same, {.few_edges = 2}).holes, 0);
  EXPECT_EQ(close_small_holes(holed, {.few_edges_rim_mm = 40}).holes, 1);
  EXPECT_TRUE(inspect(holed).closed());
}

TEST(Holes, NoEdgeGetsAThirdTriangle) {
  // Two triangles fraction an edge; a third on it makes it knotted: nothing there may be closed.
  TriMesh fin;
  fin.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  fin.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  TriMesh same = fin;
  EXPECT_EQ(close_small_holes(same).holes, 0);
  EXPECT_EQ(same.triangles.size(), 3);
  // A lone triangle has a rim of three that would be its own back.
  TriMesh lone;
  lone.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  lone.triangles = {{0, 1, 2}};
  close_small_holes(lone);
  EXPECT_EQ(lone.triangles.size(), 1);
}

}  // namespace
}  // namespace condyle
