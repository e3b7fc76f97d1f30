// Lashes are part of the eyes' mesh, but they grow from the skin.
#include "render/face/lashes.h"

#include <numbers>

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

TEST(LashRadii, AreTheStrandsOwn) {
  TriMesh mesh = eye_with_lash();
  const std::vector<float> radii = lash_radii(mesh);
  const std::size_t eye = ball({0, 0, 0}, 8).vertices.size();
  ASSERT_EQ(radii.size(), mesh.vertices.size());
  // The mean radius of a long ellipsoid over its surface: 2 V / A = 8 / (3 pi) r.
  for (std::size_t v = 0; v < radii.size(); ++v)
    EXPECT_NEAR(radii[v], v < eye ? 0 : 0.23 * 8 / (3 * std::numbers::pi), 0.02);
}

TEST_F(Lashes, ThinnerThanAPixelAreDrawnWithoutGapsAndPaler) {
  // An oblique lash of 0.12 mm across, beside a spot of skin, in pixels of 1 mm.
  TriMesh eyes = ball({0, -30, 0}, 4);
  const TriMesh strand = ball({0, 0, 0}, 1, 16);
  const int first = static_cast<int>(eyes.vertices.size());
  for (const auto& v : strand.vertices)
    eyes.vertices.push_back({0.06 * v.x() + 6 * v.z() + 14, -48 + 0.06 * v.y(), 15 * v.z() + 30});
  for (const auto& t : strand.triangles) eyes.triangles.push_back(t.array() + first);
  std::vector<Part> parts = {make_part("eyes", Role::eyes, eyes),
                             make_part("face", Role::face, ball({14, -48, 12}, 2))};
  parts[0].mesh.colors.assign(eyes.vertices.size(), {0.02f, 0.02f, 0.02f});
  parts[1].mesh.colors.assign(parts[1].mesh.vertices.size(), {0.8f, 0.6f, 0.5f});
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.samples = 1;
  settings.shadows = false;
  const Image image = renderer.picture(front_camera(200), settings);
  int gaps = 0, brightest = 0, skin = 0;
  for (int y = 60; y < 80; ++y) {
    int most = 0;
    for (int x = 105; x < 125; ++x)
      if (const Pixel p = pixel(image, x, y); p.a > most) {
        most = p.a;
        brightest = std::max<int>(brightest, p.r);
      }
    gaps += most < 255;
  }
  for (int y = 84; y < 92; ++y)
    for (int x = 105; x < 125; ++x) skin = std::max<int>(skin, pixel(image, x, y).r);
  EXPECT_EQ(gaps, 0);
  EXPECT_GT(skin, 120);
  EXPECT_GT(brightest, 0.4 * skin);
  EXPECT_LT(brightest, 1.1 * skin);
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
