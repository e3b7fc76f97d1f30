#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "engine/collide/broadphase.h"
#include "engine/collide/depenetration.h"
#include "engine/collide/overlap_measure.h"
#include "engine/core/error.h"
#include "tests/engine/collide/triangle_oracle.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Typical flaws of files, on an otherwise closed sphere.
TriMesh with_degenerate_triangles(TriMesh mesh) {
  mesh.triangles.emplace_back(3, 3, 3);
  mesh.triangles.emplace_back(1, 1, 7);
  const auto t = mesh.triangles.front();
  mesh.vertices.push_back(0.5 * (mesh.vertices[t[0]] + mesh.vertices[t[1]]));  // on a line
  mesh.triangles.emplace_back(t[0], static_cast<int>(mesh.vertices.size()) - 1, t[1]);
  return mesh;
}

TriMesh with_duplicates(TriMesh mesh) {
  mesh.triangles.push_back(mesh.triangles[3]);
  return mesh;
}

TriMesh doubled(TriMesh mesh) {
  const auto once = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
  return mesh;
}

TriMesh inward(TriMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriMesh some_flipped(TriMesh mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 7)
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  return mesh;
}

TriMesh with_a_fin(TriMesh mesh) {  // an edge with three triangles
  const auto t = mesh.triangles.front();
  mesh.vertices.push_back(1.3 * mesh.vertices[t[2]]);
  mesh.triangles.emplace_back(t[0], t[1], static_cast<int>(mesh.vertices.size()) - 1);
  return mesh;
}

TriMesh with_unused_vertices(TriMesh mesh) {
  mesh.vertices.insert(mesh.vertices.begin(), Vector3d(500, 0, 0));
  for (auto& t : mesh.triangles) t += Eigen::Vector3i::Ones();
  mesh.vertices.emplace_back(0, -900, 0);
  return mesh;
}

struct Broken {
  const char* name;
  TriMesh mesh;
  bool inside_known;
};

std::vector<Broken> all_broken() {
  const TriMesh ball = test::sphere(2, 10);
  return {{"degenerate", with_degenerate_triangles(ball), false},
          {"one duplicate", with_duplicates(ball), false},
          {"doubled", doubled(ball), true},
          {"inward", inward(ball), true},
          {"some flipped", some_flipped(ball), false},
          {"fin", with_a_fin(ball), false},
          {"unused vertices", with_unused_vertices(ball), true}};
}

TEST(BrokenMesh, DistanceIsStillThatOfItsTriangles) {
  std::mt19937_64 random(71);
  const TriMesh other = test::sphere(1, 6);
  const CollisionMesh b(other);
  for (const auto& broken : all_broken()) {
    SCOPED_TRACE(broken.name);
    const CollisionMesh a(broken.mesh);
    for (int k = 0; k < 6; ++k) {
      const Pose X_WA = test::any_pose(random, 10), X_WB = test::any_pose(random, 25);
      EXPECT_NEAR(distance(a, X_WA, b, X_WB).distance_mm,
                  test::brute_force_distance(broken.mesh, X_WA, other, X_WB), 1e-9);
    }
  }
}

TEST(BrokenMesh, DepthAndVolumeAreRightOrTheInsideIsReportedUnknown) {
  const TriMesh whole = test::sphere(2, 10), other = test::box({8, -3, -3}, {20, 3, 3});
  const Solid b(other), reference(whole);
  const double depth = overlap_depth(reference, {}, b, {}).depth_mm,
               volume = overlap_volume(whole, {}, other, {}).mm3;
  ASSERT_GT(depth, 1);
  for (const auto& broken : all_broken()) {
    SCOPED_TRACE(broken.name);
    const Solid a(broken.mesh);
    const SignedSurface surface(broken.mesh);
    EXPECT_EQ(a.open_shell_count() == 0, broken.inside_known);
    EXPECT_EQ(surface.has_open_shells(), !broken.inside_known);
    const OverlapDepth found = overlap_depth(a, {}, b, {});
    EXPECT_TRUE(std::isfinite(found.depth_mm) && found.point.allFinite());
    const auto region = contact_region(surface, {}, other, {});
    EXPECT_TRUE(std::isfinite(region.area_mm2) && region.normal.allFinite());
    const TriMesh closed = closed_shells(broken.mesh);
    if (!broken.inside_known) {
      EXPECT_TRUE(closed.empty());
      EXPECT_EQ(push_out({CollisionMesh(broken.mesh), a}, {}, {CollisionMesh(other), b}, {}).status,
                Depenetration::Status::unknown);
      continue;
    }
    EXPECT_NEAR(found.depth_mm, depth, 2 * (2e-4 + 1e-3 * depth));
    EXPECT_NEAR(overlap_volume(closed, {}, other, {}).mm3, volume, 1e-3 * volume);
    EXPECT_NEAR(surface.distance({0, 0, 1}), reference.signed_distance({0, 0, 1}), 1e-9);
    EXPECT_EQ(push_out({CollisionMesh(broken.mesh), a}, {}, {CollisionMesh(other), b}, {}).status,
              Depenetration::Status::found);
  }
}

TEST(BrokenMesh, ASheetCoveredOnBothSidesHasNoInside) {
  TriMesh sheet;
  sheet.vertices = {{-20, -20, 0}, {20, -20, 0}, {0, 30, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}};
  const Solid solid(sheet);
  EXPECT_EQ(solid.open_shell_count(), 1);
  EXPECT_EQ(overlap_depth(solid, {}, Solid(test::sphere(2, 5, {0, 0, 2})), {}).depth_mm > 1, true);
  EXPECT_NEAR(SignedSurface(sheet).distance({0, 0, -3}), 3, 1e-12);
  EXPECT_NEAR(SignedSurface(sheet).distance({0, 0, 3}), 3, 1e-12);
}

TEST(BrokenMesh, UnusableSurfacesAreRefusedByName) {
  const auto refused = [](const TriMesh& mesh, const std::string& what) {
    for (int kind = 0; kind < 3; ++kind) try {
        if (kind == 0) CollisionMesh{mesh};
        if (kind == 1) Solid{mesh};
        if (kind == 2) SignedSurface{mesh};
        ADD_FAILURE() << what << " was taken by " << kind;
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
      }
  };
  TriMesh mesh = test::sphere(1, 5);
  refused({}, "without triangles");
  mesh.vertices[7].y() = std::numeric_limits<double>::quiet_NaN();
  refused(mesh, "vertex 7");
  mesh.vertices[7].y() = std::numeric_limits<double>::infinity();
  refused(mesh, "vertex 7");
  mesh = test::sphere(1, 5);
  mesh.triangles[4][2] = 4242;
  refused(mesh, "vertex 4242");
  mesh.triangles[4][2] = -1;
  refused(mesh, "triangle 4");
}

TEST(BrokenMesh, BroadphaseUsesTheTrianglesNotTheUnusedVertices) {
  const CollisionMesh a(with_unused_vertices(test::sphere(2, 10))), b(test::sphere(2, 10));
  const std::vector<const CollisionMesh*> bodies = {&a, &b};
  const std::vector<Pose> poses = {{}, {Eigen::Quaterniond::Identity(), {300, 0, 0}}};
  EXPECT_TRUE(Broadphase(bodies).near(poses, 5).empty());
}

}  // namespace
}  // namespace condyle
