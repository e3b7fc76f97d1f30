// Lashes are part of the eyes' mesh, but they grow from the skin.
#include "render/face/lashes.h"

#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using Lashes = WithContext;

/// A ball with a strand in front of it, thin and closed, 12 mm long.
TriMesh eye_with_lash() {
  TriMesh mesh = ball({0, -30, 0}, 8);
  TriMesh strand = ball({0, 0, 0}, 1, 8);
  const int first = static_cast<int>(mesh.vertices.size());
  for (const auto& v : strand.vertices)
    mesh.vertices.push_back({0.22 + 0.23 * v.x(), -48 + 0.23 * v.y(), 6 * v.z() + 12});
  for (const auto& t : strand.triangles) mesh.triangles.push_back(t.array() + first);
  return mesh;
}

/// Visibility of the strand: alpha of the densest pixel in its middle.
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
  // A cornea may be closed and as thin, but it is wide.
  const TriMesh cornea = ball({0, 0, 0}, 1, 8);
  const int next = static_cast<int>(mesh.vertices.size());
  for (const auto& v : cornea.vertices)
    mesh.vertices.push_back({6 * v.x(), -45 + 0.1 * v.y(), 6 * v.z()});
  for (const auto& t : cornea.triangles) mesh.triangles.push_back(t.array() + next);
  EXPECT_EQ(part_lashes(mesh).lashes.size(), strand);
  EXPECT_EQ(part_lashes(mesh).eyes.size(), eye + 2 + cornea.triangles.size());
}

TEST_F(Lashes, FollowTheSkin) {
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

// Between the lids and on the iris: within 29 degrees of the gaze, and 15 up or down.
TEST_F(Lashes, DoNotHideALightThatTheEyeMirrorsFromTheFrontOrEitherSide) {
  Part eye = make_part("eyes", Role::eyes, ball({0, 0, 0}, 12, 96));
  eye.mesh.colors.assign(eye.mesh.vertices.size(), {0.25f, 0.18f, 0.1f});
  const std::vector<Part> parts = {eye};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.shadows = false;
  for (const double turn : {-0.64, -0.35, 0.0, 0.35, 0.64}) {
    Camera camera = front_camera(30);
    camera.direction = {std::sin(turn), -std::cos(turn), 0};
    const Image image = renderer.picture(camera, settings);
    int brightest = 0, dark = 0, all = 0;
    for (int y = 20; y < 180; ++y)
      for (int x = 20; x < 180; ++x) {
        const double right = (x - 99.5) / 80, up = (99.5 - y) / 80;
        const double near = std::sqrt(std::max(0.0, 1 - right * right - up * up));
        const double ahead = near * std::cos(turn) - right * std::sin(turn);
        if (ahead < std::cos(0.5) || std::abs(up) > 0.26) continue;
        const Pixel p = pixel(image, x, y);
        brightest = std::max(brightest, std::min({p.r, p.g, p.b}));
        dark += p.b < 90;
        ++all;
      }
    EXPECT_GT(brightest, 180) << turn;
    EXPECT_GT(dark, 0.7 * all) << turn;
  }
}

TEST_F(Lashes, StayWhereThePatientHasNoSkin) {
  const std::vector<Part> parts = {make_part("eyes", Role::eyes, eye_with_lash())};
  SceneRenderer renderer(parts);
  EXPECT_GT(strand_in(renderer.picture(front_camera(), mask_settings())), 50);
}

}  // namespace
}  // namespace condyle
