// Life of a drawn face: its pictures depend on the frame alone, and without life nothing changes.
#include "render/scene/face_shape.h"

#include <optional>

#include "tests/render/life/eye_parts.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using LifePictures = WithContext;

/// Both eyeballs in blue between the lids of a skin.
std::vector<Part> eye_and_lids(int around = 120) {
  const TriMesh lids = open_lids(around);
  TriMesh eye = about_both_eyes(eyeball(), eyeball()), skin = about_both_eyes(lids, lids);
  eye.colors.assign(eye.vertices.size(), {0.1f, 0.2f, 1});
  skin.colors.assign(skin.vertices.size(), {0.8f, 0.6f, 0.5f});
  return {make_part("face", Role::face, skin), make_part("eyes", Role::eyes, eye)};
}

PictureSettings alive() {
  PictureSettings settings = mask_settings();
  settings.shadows = false;
  settings.life = Life{};
  return settings;
}

/// Sees the left eye.
Camera eye_camera() {
  Camera camera = front_camera(26);
  camera.target = eye_centre;
  return camera;
}

FrameState frame_at(double time_s) {
  FrameState frame;
  frame.time_s = time_s;
  return frame;
}

/// The first time of so much closure.
double time_of(double closure) {
  double time_s = 0;
  while (life_signs(time_s).lids.left < closure) time_s += 0.001;
  return time_s;
}

int blue_in(const Image& image) {
  int count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Pixel p = pixel(image, x, y);
      count += p.a > 128 && p.b > p.r + 40;
    }
  return count;
}

TEST_F(LifePictures, ClosedLidsHideTheEyeball) {
  const std::vector<Part> parts = eye_and_lids();
  SceneRenderer renderer(parts);
  const auto blue_at = [&](double time_s, double turn) {
    Camera camera = eye_camera();
    camera.direction = {std::sin(turn), -std::cos(turn), 0};
    renderer.update(frame_at(time_s));
    return blue_in(renderer.picture(camera, alive()));
  };
  for (const double turn : {-0.6, 0.0, 0.6}) {
    const int open = blue_at(0, turn), half = blue_at(time_of(0.5), turn);
    EXPECT_GT(open, 1500);
    EXPECT_GT(half, 0.2 * open);
    EXPECT_LT(half, 0.8 * open);
    EXPECT_EQ(blue_at(time_of(1), turn), 0);
  }
}

TEST_F(LifePictures, AreThoseWithoutLifeOnceItIsOffAndInGlass) {
  const std::vector<Part> parts = eye_and_lids();
  SceneRenderer renderer(parts), other(renderer);
  const FrameState frame = frame_at(time_of(0.6));
  auto off = alive();
  off.life.reset();
  renderer.update(frame);
  other.update(frame);
  const Image without = renderer.picture(eye_camera(), off);
  const Image with = renderer.picture(eye_camera(), alive());
  EXPECT_NE(with.rgba, without.rgba);
  EXPECT_EQ(renderer.picture(eye_camera(), off).rgba, without.rgba);
  EXPECT_EQ(other.picture(eye_camera(), alive()).rgba, with.rgba) << "in any order";
  renderer.update(frame_at(0));
  renderer.picture(eye_camera(), alive());
  renderer.update(frame);
  EXPECT_EQ(renderer.picture(eye_camera(), alive()).rgba, with.rgba);
  off.skin_opacity = 0.5;
  const Image glass = renderer.picture(eye_camera(), off);
  off.life = Life{};
  EXPECT_EQ(renderer.picture(eye_camera(), off).rgba, glass.rgba);
}

FrameState frame_closing(const LidClosure& lids, double time_s = 0) {
  FrameState frame = frame_at(time_s);
  frame.lids = lids;
  return frame;
}

/// Of all channels, levels.
int largest_difference(const Image& a, const Image& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    most = std::max(most, std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
  return most;
}

TEST_F(LifePictures, AnExpressionClosesTheLidsWithLifeAndWithout) {
  const std::vector<Part> parts = eye_and_lids();
  SceneRenderer renderer(parts);
  auto off = alive();
  off.life.reset();
  const auto picture = [&](const FrameState& frame, const PictureSettings& settings) {
    renderer.update(frame);
    return renderer.picture(eye_camera(), settings);
  };
  const Image open = picture(frame_at(0), off);
  const int blue = blue_in(open);
  EXPECT_EQ(blue_in(picture(frame_closing({1, 0}), off)), 0);
  EXPECT_LE(largest_difference(picture(frame_closing({0, 1}), off), open), 1)
      << "the other eye's lid, but for the rounding of light";
  const int half = blue_in(picture(frame_closing({0.5, 0}), off));
  EXPECT_GT(half, 0.2 * blue);
  EXPECT_LT(half, 0.8 * blue);
  EXPECT_EQ(picture(frame_at(0), off).rgba, open.rgba) << "in any order";
  // With life the larger closure of both is drawn.
  EXPECT_EQ(blue_in(picture(frame_closing({1, 0}), alive())), 0);
  const double blinking_s = time_of(0.6);
  EXPECT_EQ(picture(frame_closing({0.3, 0.3}, blinking_s), alive()).rgba,
            picture(frame_at(blinking_s), alive()).rgba);
  EXPECT_EQ(blue_in(picture(frame_closing({1, 1}, blinking_s), alive())), 0);
  // Skin in glass closes, too.
  off.skin_opacity = 0.5;
  EXPECT_NE(picture(frame_closing({1, 0}), off).rgba, picture(frame_at(0), off).rgba);
}

TEST_F(LifePictures, AWeakSideBlinksInPart) {
  const std::vector<Part> parts = eye_and_lids();
  SceneRenderer renderer(parts);
  const auto blue = [&](const FrameState& frame, const LidStrength& lids) {
    auto settings = alive();
    settings.life->lids = lids;
    renderer.update(frame);
    return blue_in(renderer.picture(eye_camera(), settings));
  };
  const FrameState blinking = frame_at(time_of(1));
  EXPECT_EQ(blue(blinking, {1, 0}), 0) << "the right eye is not in the picture";
  const int open = blue(frame_at(0), {});
  EXPECT_GT(blue(blinking, {0, 1}), 0.9 * open);
  const int half = blue(blinking, {0.5, 1});
  EXPECT_GT(half, 0.2 * open);
  EXPECT_LT(half, 0.8 * open);
  // An expression that closes the lids was weakened before.
  EXPECT_EQ(blue(frame_closing({1, 1}), {0, 1}), 0);
}

TEST_F(LifePictures, ACheekThatRisesRaisesTheLowerLidWhereFoldsAreDrawn) {
  std::vector<Part> parts = eye_and_lids();
  TriMesh& skin = parts[0].mesh;
  const auto first = skin.vertices.size();
  for (const double x : {-6.0, 6.0})  // a strip of cheek below the left eye
    for (int row = 0; row < 8; ++row)
      skin.vertices.push_back(eye_centre + Eigen::Vector3d(x, -13, -13 - row));
  for (int row = 0; row < 7; ++row) {
    const int a = static_cast<int>(first) + row;
    skin.triangles.emplace_back(a, a + 8, a + 1);
    skin.triangles.emplace_back(a + 1, a + 8, a + 9);
  }
  skin.colors.resize(skin.vertices.size(), {0.8f, 0.6f, 0.5f});
  SceneRenderer renderer(parts);
  FrameState rest = frame_at(0);
  rest.face = float_positions(skin);
  FrameState risen = rest;
  for (std::size_t v = first; v < risen.face.size(); ++v) risen.face[v].z() += 2.5f;
  const auto blue = [&](const FrameState& frame, bool folds) {
    auto settings = alive();
    settings.life.reset();
    settings.folds = folds;
    renderer.update(frame);
    return blue_in(renderer.picture(eye_camera(), settings));
  };
  const int open = blue(rest, true);
  EXPECT_LT(blue(risen, true), 0.93 * open);
  EXPECT_EQ(blue(risen, false), open);
  EXPECT_LT(blue(risen, true), 0.93 * open) << "folds switched on again";
  EXPECT_EQ(blue(rest, true), open) << "back at rest";
}

/// Mean height of what is green, rows from the top; nothing without any.
std::optional<double> green_row(const Image& image) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (const Pixel p = pixel(image, x, y); p.a > 128 && p.g > p.r + 20 && p.g > p.b + 20) {
        sum += y;
        ++count;
      }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

TEST_F(LifePictures, LashesGoWithTheSkinTheyGrowFromAndBackToRest) {
  std::vector<Part> parts = eye_and_lids();
  TriMesh lash = ball({0, 0, 0}, 1, 16);
  const Eigen::Vector3d along(0, -std::cos(0.42), std::sin(0.42));
  for (auto& p : lash.vertices)
    p = eye_centre + (15.4 + 3 * p.y()) * along +
        0.2 * (p.x() * Eigen::Vector3d::UnitX() + p.z() * along.cross(Eigen::Vector3d::UnitX()));
  TriMesh& eyes = parts[1].mesh;
  const int first = static_cast<int>(eyes.vertices.size());
  eyes.vertices.insert(eyes.vertices.end(), lash.vertices.begin(), lash.vertices.end());
  for (const auto& t : lash.triangles) eyes.triangles.emplace_back(t.array() + first);
  eyes.colors.resize(eyes.vertices.size(), {0, 0.8f, 0});
  SceneRenderer renderer(parts);
  FrameState rest = frame_at(0);
  rest.face = float_positions(parts[0].mesh);
  FrameState raised = rest;
  for (auto& p : raised.face)
    if (p.z() > eye_centre.z() + 2) p.z() += 1.5f;
  for (const bool folds : {true, false}) {
    auto settings = alive();
    settings.life.reset();
    settings.folds = folds;
    const auto picture = [&](const FrameState& frame) {
      renderer.update(frame);
      return renderer.picture(eye_camera(), settings);
    };
    const Image still = picture(rest), up = picture(raised), down = picture(frame_closing({1, 1}));
    const auto row = green_row(still), row_up = green_row(up), row_down = green_row(down);
    ASSERT_TRUE(row && row_up && row_down);
    EXPECT_LT(*row_up, *row - 2);
    EXPECT_GT(*row_down, *row + 2);
    picture(raised);
    EXPECT_EQ(picture(rest).rgba, still.rgba);
  }
}

TEST(LidsNote, SaysWhyTheLidsOfAPatientDoNotMove) {
  std::vector<Part> parts = eye_and_lids();
  EXPECT_EQ(lids_note(parts), "");
  EXPECT_NE(lids_note({parts.data(), 1}).find("no eyeballs were found"), std::string::npos);
  const TriMesh closed = ball(eye_centre, 12.2, 60);
  parts[0].mesh = about_both_eyes(closed, closed);
  EXPECT_EQ(lids_note(parts), "expressions do not move the lids: no open lids were found");
  parts[0].mesh = about_both_eyes(closed, open_lids());
  EXPECT_EQ(lids_note(parts),
            "expressions do not move the left lids: no open lids were found on the left");
  parts[0].mesh = about_both_eyes(open_lids(), open_lids());
  parts[1].mesh = eyeball();
  EXPECT_EQ(lids_note(parts), "expressions do not move the right lids: no right eyeball was found");
}

TEST_F(LifePictures, TheReliefOfAClosedLidsSkinIsNotDrawnOutToStreaks) {
  const std::vector<Part> parts = eye_and_lids(240);
  SceneRenderer renderer(parts);
  renderer.update(frame_at(time_of(1)));
  Camera camera = front_camera(8);
  camera.target = eye_centre + Eigen::Vector3d(0, 0, 2);
  auto settings = alive();
  settings.width = settings.height = 400;
  const auto [across, along] = roughness(renderer.picture(camera, settings));
  EXPECT_GT(along, 1000);
  EXPECT_LT(across / along, 1.25);
  EXPECT_GT(across / along, 0.8);
}

TEST(LifeNote, SaysThatItIsForLooksAndWhatThePatientLacks) {
  const auto settings = alive();
  const std::vector<Part> parts = eye_and_lids();
  EXPECT_TRUE(life_note(parts, settings).starts_with("look only"));
  EXPECT_EQ(life_note(parts, settings).find("eye"), std::string::npos);
  EXPECT_NE(life_note(parts, settings).find("no neck was found"), std::string::npos);
  EXPECT_NE(life_note({parts.data(), 1}, settings).find("no eyeballs were found"),
            std::string::npos);
  auto glass = settings;
  glass.skin_opacity = 0.4;
  EXPECT_NE(life_note(parts, glass).find("have none"), std::string::npos);
}

}  // namespace
}  // namespace condyle
