#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>
#include <random>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/overlap_measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/engine/collide/triangle_oracle.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/places.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

std::filesystem::path real_data() { return test::source_folder() / ".." / "shared" / "data"; }

TriMesh bone(const char* file) {
  TriMesh mesh = read_mesh(real_data() / file);
  weld(mesh);
  drop_degenerate(mesh);
  drop_duplicates(mesh);
  return mesh;
}

/// Several hundred adjacent triangles of the mesh: few enough for brute force over pairs.
TriMesh patch(const TriMesh& mesh, const Eigen::Vector3d& near, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    order.emplace_back((mesh.vertices[mesh.triangles[i][0]] - near).norm(), i);
  std::sort(order.begin(), order.end());
  TriMesh part{mesh.vertices, {}, {}};
  for (std::size_t k = 0; k < std::min(count, order.size()); ++k)
    part.triangles.push_back(mesh.triangles[order[k].second]);
  drop_unreferenced(part);
  return part;
}

struct RealPair {
  const char *a, *b;
  bool a_is_open, b_is_open;
};

constexpr RealPair pairs[] = {
    {"case-ubc/maxilla.ply", "case-ubc/mandible.ply", true, false},
    {"case-ubc/maxilla_with_teeth_wrap_30k.ply", "case-ubc/lower_teeth.ply", false, false},
    {"case-badin/maxilla.ply", "case-badin/mandible.ply", true, false},
    {"case-badin/maxilla_capped.ply", "case-badin/tongue.ply", false, false},
    {"ct-cranium/skull_iso300.ply", "case-ubc/hyoid.ply", true, false}};

TEST(RealBones, DistanceEqualsBruteForceOnPatchesOpenShellsAreReportedAndDepthIsFinite) {
  if (!std::filesystem::exists(real_data())) GTEST_SKIP() << "real anatomy absent";
  std::mt19937_64 random(91);
  for (const auto& pair : pairs) {
    SCOPED_TRACE(std::string(pair.a) + " and " + pair.b);
    const TriMesh a = bone(pair.a), b = bone(pair.b);
    const CollisionMesh surface_a(a), surface_b(b);
    const Solid solid_a(a), solid_b(b);
    EXPECT_EQ(solid_a.open_shell_count() > 0, pair.a_is_open);
    EXPECT_EQ(solid_b.open_shell_count() > 0, pair.b_is_open);
    for (int k = 0; k < 4; ++k) {
      Pose X = test::any_pose(random, 4);
      X.R = Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * k, X.R * Eigen::Vector3d::UnitX()));
      const MeshDistance nearest = distance(surface_a, {}, surface_b, X);
      // A patch around each witness holds the nearest pair.
      const TriMesh near_a = patch(a, nearest.witness_a, 150),
                    near_b = patch(b, X.inverse() * nearest.witness_b, 150);
      EXPECT_NEAR(nearest.distance_mm, test::brute_force_distance(near_a, {}, near_b, X), 1e-9);
      // Nor is any sample of B nearer to A than that.
      const TriangleTree tree(a);
      for (std::size_t i = 0; i < b.vertices.size(); i += 37)
        ASSERT_GE(tree.nearest(X * b.vertices[i]).distance, nearest.distance_mm - 1e-9);
      const OverlapDepth deepest = overlap_depth(solid_a, {}, solid_b, X);
      EXPECT_TRUE(std::isfinite(deepest.depth_mm) && deepest.point.allFinite());
      EXPECT_LE(deepest.error_mm, std::max(0.05, 0.01 * deepest.depth_mm));
      if (nearest.distance_mm > 0 && !one_encloses_other(solid_a, {}, solid_b, X)) {
        EXPECT_EQ(deepest.depth_mm, 0);
      }
      const ContactRegion region = contact_region(SignedSurface(b), X, a, {});
      EXPECT_TRUE(std::isfinite(region.area_mm2));
    }
  }
}

/// Crowns that a scan has fused overlap by a millimetre at rest, on coarse and fine faces alike.
TEST(RealBones, DepthOfABiteAtRestIsProvedAndNoLessThanAtAnySample) {
  if (!std::filesystem::exists(real_data())) GTEST_SKIP() << "real anatomy absent";
  for (const char* lower : {"case-ubc/mandible_8k.ply", "case-ubc/lower_teeth.ply"})
    for (const char* upper :
         {"case-ubc/maxilla_with_teeth_wrap_30k.ply", "case-ubc/upper_teeth.ply"}) {
      SCOPED_TRACE(std::string(upper) + " and " + lower);
      const TriMesh a = bone(upper), b = bone(lower);
      const OverlapDepth found = overlap_depth(Solid(a), {}, Solid(b), {});
      EXPECT_GT(found.depth_mm, 1);
      EXPECT_LE(found.error_mm, 1e-3 * found.depth_mm);
      EXPECT_GE(found.depth_mm + found.error_mm,
                deepest(test::OverlapOracle(a), test::OverlapOracle(b), {}));
    }
}

TEST(RealBones, AWholeSkullIsBuiltAndQueriedInReasonableTime) {
  if (!std::filesystem::exists(real_data())) GTEST_SKIP() << "real anatomy absent";
  const TriMesh skull = bone("ct-cranium/skull_iso300.ply"), hyoid = bone("case-ubc/hyoid.ply");
  ASSERT_GT(skull.triangles.size(), 100000u);
  const auto now = [] {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;  // processor time, ms
  };
  const double start = now();
  const CollisionMesh surface(skull);
  const Solid solid(skull);
  const double built = now();
  const CollisionMesh surface_b(hyoid);
  const Solid solid_b(hyoid);
  std::mt19937_64 random(92);
  const double before = now();
  constexpr int queries = 20;
  for (int k = 0; k < queries; ++k) {
    const Pose X = test::any_pose(random, 30);
    distance(surface, {}, surface_b, X);
    overlap_depth(solid, {}, solid_b, X);
  }
  const double query = (now() - before) / queries;
  RecordProperty("build_ms", static_cast<int>(built - start));
  RecordProperty("query_us", static_cast<int>(1e3 * query));
  std::printf("%zu triangles: built in %.0f ms, distance and depth in %.2f ms\n",
              skull.triangles.size(), built - start, query);
  EXPECT_LT(built - start, 6000);  // some ten times what they take
  EXPECT_LT(query, 200);
}

}  // namespace
}  // namespace condyle
