#include "engine/mesh/repair.h"

#include <gtest/gtest.h>

#include "engine/mesh/measure.h"
#include "engine/mesh/shape_key.h"
#include "engine/mesh/simplify.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/engine/mesh/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using test::arbitrary_pose;
using test::cuboid;
using test::joined;
using test::moved;
using test::sphere;

TEST(Measure, VolumeAndAreaOfABoxInAnyPoseAreItsFormulas) {
  const TriMesh mesh = moved(cuboid({0, 0, 0}, {2, 3, 4}), arbitrary_pose(1));
  EXPECT_NEAR(signed_volume(mesh), 24, 1e-11);
  EXPECT_NEAR(surface_area(mesh), 2 * (6 + 8 + 12), 1e-11);
  TriMesh inward = mesh;
  flip(inward);
  EXPECT_NEAR(signed_volume(inward), -24, 1e-11);
}

TEST(Measure, VertexNormalsOfASpherePointOutwardAndOfABoxAlongItsDiagonals) {
  const TriMesh ball = sphere(3, 10);
  const auto normals = vertex_normals(ball);
  for (std::size_t i = 0; i < normals.size(); ++i)
    EXPECT_GT(normals[i].dot(ball.vertices[i].normalized()), 0.9996);  // 1.6 degrees

  // Angle weights: however a face is cut into triangles, a cube's corner normal is its diagonal.
  const TriMesh cube = cuboid({-1, -1, -1}, {1, 1, 1});
  const auto corners = vertex_normals(cube);
  for (std::size_t i = 0; i < corners.size(); ++i)
    EXPECT_LT((corners[i] - cube.vertices[i].normalized()).norm(), 1e-12);
}

TEST(Measure, HashChangesWithAnyBit) {
  TriMesh mesh = sphere(2, 10);
  const auto before = mesh_hash(mesh);
  EXPECT_EQ(before, mesh_hash(sphere(2, 10)));
  mesh.vertices[7].y() = std::nextafter(mesh.vertices[7].y(), 1e9);
  EXPECT_NE(before, mesh_hash(mesh));
}

TEST(ShapeKey, DependsOnVerticesAndTrianglesAlone) {
  const TriMesh mesh = sphere(2, 10);
  TriMesh other = mesh;
  other.colors.assign(mesh.vertices.size(), {1, 0, 0});
  EXPECT_EQ(shape_key(other), shape_key(mesh));
  EXPECT_NE(shape_key(mesh, shape_key(mesh)), shape_key(mesh)) << "chained";
  other.vertices[7].y() = std::nextafter(other.vertices[7].y(), 1e9);
  EXPECT_NE(shape_key(other), shape_key(mesh));
  other = mesh;
  std::swap(other.triangles[3], other.triangles[4]);
  EXPECT_NE(shape_key(other), shape_key(mesh));
}

TEST(Weld, RestoresAMeshThatWasTakenApart) {
  const TriMesh mesh = moved(sphere(3, 10), arbitrary_pose(2));
  TriMesh soup = test::unwelded(mesh);
  EXPECT_EQ(weld(soup), static_cast<int>(3 * mesh.triangles.size() - mesh.vertices.size()));
  EXPECT_EQ(soup.vertices.size(), mesh.vertices.size());
  EXPECT_TRUE(inspect(soup).closed());
  EXPECT_EQ(weld(soup), 0);
}

TEST(Weld, ToleranceJoinsWhatIsNearAndNothingElse) {
  TriMesh soup = test::unwelded(cuboid({0, 0, 0}, {5, 5, 5}));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shake(-1e-4, 1e-4);
  for (auto& v : soup.vertices) v += Vector3d(shake(random), shake(random), shake(random));
  TriMesh exact = soup, rough = soup;
  EXPECT_EQ(weld(exact), 0);
  weld(rough, 1e-3);
  EXPECT_EQ(rough.vertices.size(), 8u);
  EXPECT_TRUE(inspect(rough).closed());
  TriMesh apart = cuboid({0, 0, 0}, {5, 5, 5});
  EXPECT_EQ(weld(apart, 4.9), 0);
}

TEST(Weld, NegativeZeroIsZeroAndColoursStayWithTheFirst) {
  TriMesh mesh;
  mesh.vertices = {{0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {1, 1, 0}};
  mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}, {1, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {3, 1, 4}};
  EXPECT_EQ(weld(mesh), 1);
  EXPECT_EQ(mesh.triangles[1], Eigen::Vector3i(0, 1, 3));
  ASSERT_EQ(mesh.colors.size(), 4u);
  EXPECT_EQ(mesh.colors[0], Eigen::Vector3f(1, 0, 0));
  EXPECT_EQ(mesh.colors[3], Eigen::Vector3f(1, 1, 1));
}

TEST(Topology, CountsPiecesRimsAndBadEdges) {
  TriMesh mesh = joined(sphere(2, 10), cuboid({20, 0, 0}, {30, 10, 10}));
  EXPECT_TRUE(inspect(mesh).closed());
  EXPECT_EQ(inspect(mesh).components, 2);
  mesh.triangles.pop_back();  // of the box, at x = 30
  Topology open = inspect(mesh);
  EXPECT_EQ(open.boundary_edges, 3);
  ASSERT_EQ(open.boundary.size(), 1u);
  EXPECT_NEAR(open.boundary[0].length_mm, 20 + std::sqrt(200.0), 1e-12);
  EXPECT_NEAR(open.boundary[0].box.center().x(), 30, 1e-12);
  EXPECT_FALSE(open.closed());

  TriMesh fin = cuboid({0, 0, 0}, {1, 1, 1});
  fin.vertices.emplace_back(5, 5, 5);
  fin.triangles.emplace_back(0, 1, 8);
  const Topology three = inspect(fin);
  EXPECT_EQ(three.nonmanifold_edges, 1);
  EXPECT_LT((three.nonmanifold_box.center() - Vector3d(0.5, 0, 0)).norm(), 1e-12);

  TriMesh turned = cuboid({0, 0, 0}, {1, 1, 1});
  std::swap(turned.triangles[4][0], turned.triangles[4][1]);
  EXPECT_EQ(inspect(turned).misoriented_edges, 3);
}

TEST(Repair, DropsRepeatedAndCollapsedTriangles) {
  TriMesh mesh = cuboid({0, 0, 0}, {1, 1, 1});
  mesh.triangles.emplace_back(0, 0, 3);
  mesh.triangles.push_back(mesh.triangles[5]);
  mesh.triangles.emplace_back(mesh.triangles[6][1], mesh.triangles[6][0], mesh.triangles[6][2]);
  EXPECT_EQ(drop_degenerate(mesh), 1);
  EXPECT_EQ(drop_duplicates(mesh), 2);
  EXPECT_TRUE(inspect(mesh).closed());
  EXPECT_EQ(mesh.triangles.size(), 12u);
}

TEST(Repair, AFlatTriangleLeavesNoCrack) {
  // A vertex in the middle of the edge 0-1, used by one of its sides only through a flat triangle.
  TriMesh mesh = cuboid({0, 0, 0}, {2, 2, 2});
  mesh.vertices.emplace_back(1, 0, 0);
  ASSERT_EQ(mesh.triangles[0], Eigen::Vector3i(0, 2, 1));
  mesh.triangles[0] = {0, 2, 8};
  mesh.triangles.emplace_back(8, 2, 1);
  mesh.triangles.emplace_back(0, 8, 1);  // flat: closes the crack by topology only
  ASSERT_TRUE(inspect(mesh).closed());
  drop_degenerate(mesh);
  EXPECT_TRUE(inspect(mesh).closed());
  EXPECT_EQ(mesh.triangles.size(), 14u);
  EXPECT_NEAR(signed_volume(mesh), 8, 1e-12);
  for (const auto& t : mesh.triangles)
    EXPECT_GT((mesh.vertices[t[1]] - mesh.vertices[t[0]])
                  .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                  .norm(),
              0.1);
}

TEST(Repair, UnusedVerticesAreRemovedWithTheirColours) {
  TriMesh mesh;
  mesh.vertices = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {8, 8, 8}, {0, 1, 0}};
  mesh.colors = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 1}};
  mesh.triangles = {{1, 2, 4}};
  EXPECT_EQ(drop_unreferenced(mesh), 2);
  EXPECT_EQ(mesh.triangles[0], Eigen::Vector3i(0, 1, 2));
  EXPECT_EQ(mesh.colors[2], Eigen::Vector3f(0, 0, 1));
}

TEST(Orient, EveryMixOfWindingsOfAClosedMeshFacesOutward) {
  const TriMesh mesh = moved(sphere(2, 10), arbitrary_pose(4));
  std::mt19937 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    TriMesh mixed = mesh;
    for (auto& t : mixed.triangles)
      if (random() & 1) std::swap(t[0], t[1]);
    orient_outward(mixed);
    EXPECT_TRUE(inspect(mixed).closed());
    EXPECT_NEAR(signed_volume(mixed), signed_volume(mesh), 1e-9);
  }
}

TEST(Orient, ACavityStaysACavityAndAnInwardSolidIsTurnedWithIt) {
  TriMesh hole = sphere(2, 5);
  flip(hole);
  const TriMesh hollow = joined(sphere(2, 10), hole);
  const double volume = signed_volume(hollow);
  TriMesh good = hollow, inward = hollow;
  flip(inward);
  EXPECT_EQ(orient_outward(good).turned, 0);
  const Orientation done = orient_outward(inward);
  EXPECT_EQ(done.turned, static_cast<int>(hollow.triangles.size()));
  EXPECT_EQ(done.inward_closed, 1);
  EXPECT_NEAR(signed_volume(inward), volume, 1e-9);
  // A second solid inside the first, as a root in its jaw, stays solid.
  TriMesh rooted = joined(sphere(2, 10), sphere(2, 5));
  EXPECT_EQ(orient_outward(rooted).turned, 0);
}

TEST(Orient, OpenSurfacesKeepTheOrientationOfMostOfTheirArea) {
  TriMesh cup = sphere(2, 10);
  std::erase_if(cup.triangles, [&](const auto& t) { return cup.vertices[t[0]].z() > 3; });
  TriMesh mixed = cup;
  for (std::size_t i = 0; i < mixed.triangles.size(); i += 4)
    std::swap(mixed.triangles[i][1], mixed.triangles[i][2]);
  EXPECT_GT(inspect(mixed).misoriented_edges, 10);
  orient_outward(mixed);
  EXPECT_EQ(mixed.triangles, cup.triangles);
}

TEST(Orient, AMoebiusStripIsReported) {
  TriMesh strip;
  constexpr int n = 20;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    for (const double w : {-1.0, 1.0})
      strip.vertices.emplace_back((10 + w * std::cos(a / 2)) * std::cos(a),
                                  (10 + w * std::cos(a / 2)) * std::sin(a), w * std::sin(a / 2));
  }
  for (int i = 0; i < n; ++i) {
    const int a = 2 * i, b = 2 * i + 1;
    const bool last = i == n - 1;
    const int c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    strip.triangles.emplace_back(a, c, b);
    strip.triangles.emplace_back(b, c, d);
  }
  EXPECT_GT(orient_outward(strip).contradictions, 0);
}

TEST(Simplify, AClosedMeshStaysClosedAndNear) {
  const TriMesh mesh = moved(sphere(6, 50), arbitrary_pose(6));  // 81,920 triangles
  for (const int target : {20000, 2000, 200}) {
    const TriMesh coarse = simplify(mesh, target);
    EXPECT_TRUE(inspect(coarse).closed());
    EXPECT_LT(coarse.triangles.size(), 1.5 * target);
    // The sagitta of facets of that size: a sphere of N triangles errs by about 8 r / N.
    const TriangleTree tree(coarse);
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 97)
      EXPECT_LT(tree.nearest(mesh.vertices[i]).distance, 50.0 * 40 / target);
  }
  EXPECT_EQ(mesh_hash(simplify(mesh, 2000)), mesh_hash(simplify(mesh, 2000)));
  EXPECT_EQ(mesh_hash(simplify(mesh, 100000)), mesh_hash(mesh));
}

}  // namespace
}  // namespace condyle
