// Lashes are part of the eyes' mesh, but they grow from the skin.
#include "render/lashes.h"

#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using Lashes = WithContext;

/// A ball with a strand before it, thin and closed, 12 mm long.
TriMesh eye_with_lash() {
  TriMesh mesh = ball({0, -30, 0}, 8);
  TriMesh strand = ball({0, 0, 0}, 1, 8);
  const int first = static_cast<int>(mesh.vertices.size());
  for (const auto& v : strand.vertices)
    mesh.vertices.push_back({0.22 + 0.23 * v.x(), -48 + 0.23 * v.y(), 6 * v.z() + 12});
  for (const auto& t : strand.triangles) mesh.triangles.push_back(t.array() + first);
  return mesh;
}

/// How much is seen of the strand: alpha of the densest pixel in its middle.
int strand_in(const Image& image) {
  int most = 0;
  for (int x = 95; x < 105; ++x) most = std::max(most, pixel(image, x, 73).a);
  return most;
}

TEST(LashPieces, AreTheClosedStrandsAloneWhateverElseIsThin) {
  TriMesh mesh = eye_with_lash();
  const std::size_t strand = ball({0, 0, 0}, 1, 8).triangles.size(),
                    eye = ball({0, 0, 0}, 8).triangles.size();
  EXPECT_EQ(part_lashes(mesh).lashes.size(), strand);
  EXPECT_EQ(part_lashes(mesh).eyes.size(), eye);
  // A flat iris is no closed piece.
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Eigen::Vector3d& v : {Eigen::Vector3d(-3, -40, -3), Eigen::Vector3d(3, -40, -3),
                                   Eigen::Vector3d(3, -40, 3), Eigen::Vector3d(-3, -40, 3)})
    mesh.vertices.push_back(v);
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
  EXPECT_EQ(part_lashes(mesh).lashes.size(), strand);
  EXPECT_EQ(part_lashes(mesh).eyes.size(), eye + 2);
}

TEST_F(Lashes, GoWithTheSkin) {
  // The skin lies behind, so that it hides neither eye nor lash.
  const std::vector<Part> parts = {make_part("eyes", Role::eyes, eye_with_lash()),
                                   make_part("face", Role::face, ball({0, 40, 0}, 8))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.shadows = false;
  const auto lash = [&] { return strand_in(renderer.picture(front_camera(), settings)); };
  const auto eye = [&] { return pixel(renderer.picture(front_camera(), settings), 100, 100).a; };
  const int whole = lash();
  EXPECT_GT(whole, 50);
  settings.skin_opacity = 0;
  EXPECT_EQ(lash(), 0);
  EXPECT_EQ(eye(), 255);
  settings.skin_opacity = 0.4;
  EXPECT_GT(lash(), 0.2 * whole);
  EXPECT_LT(lash(), 0.8 * whole);
  EXPECT_EQ(eye(), 255);
  settings.skin_opacity = 1;
  settings.part_opacity["face"] = 0;
  EXPECT_EQ(lash(), 0);
  settings.part_opacity.clear();
  settings.clip = {.point = {0, 0, 8}, .normal = {0, 0, 1}, .parts = {"face"}};
  EXPECT_EQ(lash(), 0);
  settings.clip.reset();
  settings.part_opacity["eyes"] = 0;
  EXPECT_EQ(lash(), 0);
}

TEST_F(Lashes, StayWhereThePatientHasNoSkin) {
  const std::vector<Part> parts = {make_part("eyes", Role::eyes, eye_with_lash())};
  SceneRenderer renderer(parts);
  EXPECT_GT(strand_in(renderer.picture(front_camera(), mask_settings())), 50);
}

}  // namespace
}  // namespace condyle
