#include <random>

#include "render/mesh/ambient_occlusion.h"
#include "render/mesh/vertex_normals.h"
#include "render/shaders/skin_table.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

struct Surface {
  std::vector<Eigen::Vector3f> vertices, normals;
  std::vector<Eigen::Vector3i> triangles;

  explicit Surface(const TriMesh& mesh, bool inward = false) : triangles(mesh.triangles) {
    for (const auto& v : mesh.vertices) vertices.push_back(v.cast<float>());
    if (inward)
      for (auto& t : triangles) std::swap(t[1], t[2]);
    vertex_normals(vertices, triangles, normals);
  }
  OcclusionSurface of(int layer, unsigned alone, unsigned together) const {
    return {vertices, normals, triangles, layer, alone, together};
  }
};

TEST(Normals, OfABallPointOutAndItsCurvatureIsOneOverTheRadius) {
  const Eigen::Vector3d centre(3, -7, 11);
  const TriMesh mesh = ball(centre, 20);
  const Surface surface(mesh);
  const auto curvature = vertex_curvature(surface.vertices, surface.triangles, surface.normals);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_GT(surface.normals[i].dot((mesh.vertices[i] - centre).normalized().cast<float>()),
              0.999f);
    EXPECT_NEAR(curvature[i], 1 / 20.0, 0.006);
  }
}

TEST(Normals, ASurfaceIsClosedUntilOneTriangleIsTakenOrTurned) {
  auto mesh = ball({0, 0, 0}, 10, 12);
  EXPECT_TRUE(is_closed_surface(mesh.triangles));
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  EXPECT_FALSE(is_closed_surface(mesh.triangles));
  mesh.triangles.erase(mesh.triangles.begin() + 5);
  EXPECT_FALSE(is_closed_surface(mesh.triangles));
  EXPECT_FALSE(is_closed_surface({}));
}

TEST(Occlusion, NothingShadesABallFromOutsideAndAllFromInside) {
  const Surface outward(ball({5, 5, 5}, 40)), inward(ball({5, 5, 5}, 40), true);
  for (const auto& [surface, expected] : {std::pair{&outward, 1.f}, {&inward, 0.f}}) {
    const OcclusionSurface one[] = {surface->of(0, 1, 1)};
    const auto result = bake_occlusion(one, 48, 2);
    for (const float value : result[0].alone) ASSERT_NEAR(value, expected, 0.06f);
  }
}

TEST(Occlusion, ALayerShadesOnlyThoseThatNameIt) {
  // Two balls that nearly touch: at the gap each hides half the other's sky.
  const Surface a(ball({0, 0, 0}, 30)), b(ball({0, 0, 62}, 30));
  const OcclusionSurface both[] = {a.of(0, 1, 3), b.of(1, 2, 3)};
  const auto result = bake_occlusion(both, 64, 2);
  EXPECT_NEAR(result[0].alone.front(), 1, 0.05);    // top of a, its own layer only
  EXPECT_LT(result[0].together.front(), 0.35);      // with b over it
  EXPECT_NEAR(result[0].together.back(), 1, 0.05);  // its far side
  EXPECT_LT(result[1].together.back(), 0.35);
}

TEST(Occlusion, IsTheSameForAnyNumberOfThreads) {
  const Surface a(ball({0, 0, 0}, 30)), b(ball({0, 20, 40}, 30));
  const OcclusionSurface both[] = {a.of(0, 1, 3), b.of(1, 2, 3)};
  const auto one = bake_occlusion(both, 20, 1), two = bake_occlusion(both, 20, 3);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(one[k].alone, two[k].alone);
    EXPECT_EQ(one[k].together, two[k].together);
  }
}

TEST(SkinTable, FlatSkinFollowsTheCosineAndBentSkinBleedsRed) {
  const SkinTable table = make_skin_table();
  const auto at = [&](int column, int row, int channel) {
    return table.rgb[3 * (row * SkinTable::width + column) + channel] / 255.0;
  };
  for (int column = 0; column < SkinTable::width; column += 7) {
    const double cosine = -1 + 2.0 * column / (SkinTable::width - 1);
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(at(column, 1, channel), std::max(cosine, 0.0), 0.03);
  }
  const int dark = SkinTable::width * 2 / 5, bent = SkinTable::height - 1;  // beyond the edge
  EXPECT_GT(at(dark, bent, 0), 0.05);
  EXPECT_GT(at(dark, bent, 0), 1.5 * at(dark, bent, 1));
  EXPECT_GE(at(dark, bent, 1), at(dark, bent, 2));
}

}  // namespace
}  // namespace condyle
