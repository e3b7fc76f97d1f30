#include <Eigen/Geometry>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>

#include "tests/render/scene_fixture.h"
#include "tests/support/bodies.h"

namespace condyle {
namespace {

using Scene = WithContext;

TEST(Context, NeedsNoDisplay) {
  ::unsetenv("DISPLAY");
  ::unsetenv("WAYLAND_DISPLAY");
  const OffscreenContext context;
  EXPECT_NE(context.description().find("EGL"), std::string::npos) << context.description();
}

class SoftwareRequested : public testing::Test {
 protected:
  void SetUp() override {
    const char* value = std::getenv(name);
    if (value) before_ = value;
  }
  void TearDown() override {
    if (before_)
      ::setenv(name, before_->c_str(), 1);
    else
      ::unsetenv(name);
  }
  static constexpr const char* name = "LIBGL_ALWAYS_SOFTWARE";
  std::optional<std::string> before_;
};

TEST_F(SoftwareRequested, IgnoresGraphicsCards) {
  for (const char* yes : {"1", "true", "yes", "Y"}) {
    ::setenv(name, yes, 1);
    EXPECT_TRUE(software_gl_requested()) << yes;
  }
  for (const char* no : {"", "0", "false", "no", "N"}) {
    ::setenv(name, no, 1);
    EXPECT_FALSE(software_gl_requested()) << no;
  }
  ::unsetenv(name);
  EXPECT_FALSE(software_gl_requested());
  // Where there is a card it would be the first choice.
  ::setenv(name, "1", 1);
  const OffscreenContext context;
  EXPECT_EQ(context.description().find("hardware"), std::string::npos) << context.description();
}

TEST_F(Scene, ABallIsARoundDiscInTheMiddle) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  const Image image = renderer.picture(front_camera(), mask_settings());
  const Blob blob = blob_of(image);
  // The outline of a ball seen from near is that of a slightly larger disc.
  const double radius = 200 / 100.0 * 30 / std::sqrt(1 - 30.0 * 30 / (500.0 * 500));
  EXPECT_NEAR(blob.area, std::numbers::pi * radius * radius, 0.01 * blob.area);
  EXPECT_NEAR(blob.centre.x(), 100, 0.1);
  EXPECT_NEAR(blob.centre.y(), 100, 0.1);
  EXPECT_NEAR(blob.variance.x(), radius * radius / 4, 0.01 * blob.variance.x());
  EXPECT_NEAR(blob.variance.y(), blob.variance.x(), 0.005 * blob.variance.x());
}

TEST_F(Scene, BoneIsWarmAndLightAndTheBackgroundAQuietGrey) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  const Image image = renderer.picture(front_camera(), settings);
  const Pixel bone = pixel(image, 90, 88);
  EXPECT_GT(bone.r, 170);
  EXPECT_GT(bone.r, bone.g);
  EXPECT_GT(bone.g, bone.b + 8);
  for (const auto& [x, y] : {std::pair{2, 2}, {197, 2}, {2, 197}, {197, 197}, {100, 5}}) {
    const Pixel p = pixel(image, x, y);
    EXPECT_EQ(p.a, 255);
    EXPECT_LT(std::max({p.r, p.g, p.b}), 110);
    EXPECT_LT(std::max({p.r, p.g, p.b}) - std::min({p.r, p.g, p.b}), 16);
  }
}

TEST_F(Scene, ALightBackdropChangesOnlyTheBackground) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  const Image dark = renderer.picture(front_camera(), settings);
  settings.backdrop = Backdrop::light;
  const Image light = renderer.picture(front_camera(), settings);
  for (const auto& [x, y] :
       {std::pair{2, 2}, {197, 2}, {2, 197}, {197, 197}, {100, 5}, {100, 30}}) {
    const Pixel p = pixel(light, x, y);
    EXPECT_EQ(p.a, 255);
    EXPECT_GT(std::min({p.r, p.g, p.b}), 180);
    EXPECT_LT(std::max({p.r, p.g, p.b}) - std::min({p.r, p.g, p.b}), 20);
  }
  for (int y = 60; y < 140; ++y)
    for (int x = 60; x < 140; ++x) ASSERT_EQ(pixel(light, x, y).r, pixel(dark, x, y).r);
  settings.backdrop = Backdrop::dark;
  EXPECT_TRUE(test::same_bytes(dark, renderer.picture(front_camera(), settings)));
}

TEST_F(Scene, TheSamePictureTwiceHasTheSameBytes) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30)),
                                   make_part("face", Role::face, ball({0, -5, 0}, 33))};
  PictureSettings settings;
  settings.width = 320;
  settings.height = 240;
  settings.skin_opacity = 0.5;
  SceneRenderer first(parts), second(parts);
  const Image a = first.picture(front_camera(), settings);
  settings.width = 64;
  first.picture(front_camera(), settings);  // another size in between changes nothing
  settings.width = 320;
  EXPECT_TRUE(test::same_bytes(a, first.picture(front_camera(), settings)));
  EXPECT_TRUE(test::same_bytes(a, second.picture(front_camera(), settings)));
}

TEST_F(Scene, OpacityZeroEqualsAbsence) {
  const std::vector<Part> both = {make_part("skull", Role::skull, ball({0, 0, 0}, 25)),
                                  make_part("face", Role::face, ball({0, 0, 0}, 35))};
  const std::vector<Part> bare = {both[0],
                                  make_part("face", Role::face, {both[1].mesh.vertices, {}, {}})};
  PictureSettings settings;
  settings.width = settings.height = 160;
  SceneRenderer with(both), without(bare);
  const Image whole = with.picture(front_camera(), settings);
  settings.skin_opacity = 0;
  const Image skin_hidden = with.picture(front_camera(), settings);
  settings.skin_opacity = 1;
  settings.part_opacity["face"] = 0;
  const Image part_hidden = with.picture(front_camera(), settings);
  const Image absent = without.picture(front_camera(), settings);
  EXPECT_TRUE(test::unlike(whole, skin_hidden, 0));
  EXPECT_TRUE(test::same_bytes(skin_hidden, part_hidden));
  EXPECT_TRUE(test::same_bytes(skin_hidden, absent));
}

TEST_F(Scene, HalfOpaqueSkinShowsWhatLiesUnderItBetweenBothPictures) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 25)),
                                   make_part("face", Role::face, ball({0, 0, 0}, 35))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 160;
  settings.shadows = false;
  const auto blue = [&](double opacity) {
    settings.skin_opacity = opacity;
    return pixel(renderer.picture(front_camera(), settings), 70, 70).b;
  };
  const int skin = blue(1), half = blue(0.5), bone = blue(0);
  ASSERT_GT(bone, skin + 20);
  EXPECT_GT(half, skin + 5);
  EXPECT_LT(half, bone - 5);
}

/// Pixels that differ by more than 3 of 255 in a channel.
int unlike_pixels(const Image& one, const Image& other) {
  int count = 0;
  for (int y = 0; y < one.height; ++y)
    for (int x = 0; x < one.width; ++x) {
      const auto a = pixel(one, x, y), b = pixel(other, x, y);
      count += std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b),
                         std::abs(a.a - b.a)}) > 3;
    }
  return count;
}

/// The same between a picture with one sample per pixel and with four.
int unlike_by_samples(SceneRenderer& renderer, PictureSettings settings) {
  settings.samples = 1;
  const Image plain = renderer.picture(front_camera(), settings);
  settings.samples = 4;
  return unlike_pixels(plain, renderer.picture(front_camera(), settings));
}

TEST_F(Scene, TranslucentSkinOfOneSampleIsThatOfSeveral) {
  // Shaded deferred with one sample, forward with several. A mouth shows the inner side.
  TriMesh head = ball({0, 0, 0}, 35);
  std::erase_if(head.triangles, [&](const Eigen::Vector3i& t) {
    const Eigen::Vector3d& p = head.vertices[static_cast<std::size_t>(t[0])];
    return p.y() < 0 && std::hypot(p.x(), p.z() + 8) < 12;
  });
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({9, 0, 12}, 14)),
                                   make_part("face", Role::face, head)};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 300;
  settings.smooth_edges = false;
  for (const double opacity : {0.3, 0.7}) {
    SCOPED_TRACE(opacity);
    settings.skin_opacity = opacity;
    EXPECT_LT(unlike_by_samples(renderer, settings), 1500);  // along the outlines
    settings.samples = 1;
    const Image plain = renderer.picture(front_camera(), settings);
    settings.skin_opacity = 0;
    EXPECT_TRUE(test::unlike(plain, renderer.picture(front_camera(), settings), 0.01));
  }
}

TEST_F(Scene, SeveralTranslucentPartsOfOneSampleAreThoseOfSeveral) {
  TriMesh shell = ball({0, 0, 6}, 18);
  std::erase_if(shell.triangles, [&](const Eigen::Vector3i& t) {
    return shell.vertices[static_cast<std::size_t>(t[0])].z() > 14;
  });
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({12, 0, 12}, 14)),
                                   make_part("mandible", Role::mandible, ball({-6, -9, -8}, 12)),
                                   make_part("maxilla", Role::maxilla, shell),
                                   make_part("face", Role::face, ball({0, 0, 0}, 35))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 300;
  settings.smooth_edges = false;
  settings.part_opacity = {{"skull", 0.5}, {"mandible", 0.5}, {"maxilla", 0.5}};
  settings.skin_opacity = 0.4;
  for (const bool transparent : {false, true}) {
    settings.transparent = transparent;
    EXPECT_LT(unlike_by_samples(renderer, settings), 1500);  // along the outlines
  }
}

TEST_F(Scene, TheMandibleMovesByItsPoseAndTheSkullStays) {
  const std::vector<Part> jaw = {make_part("mandible", Role::mandible, ball({0, 0, 0}, 15)),
                                 make_part("skull", Role::skull, ball({0, 0, 30}, 5))};
  SceneRenderer renderer(jaw);
  auto settings = mask_settings();
  settings.part_opacity["skull"] = 0;
  const Blob rest = blob_of(renderer.picture(front_camera(), settings));
  FrameState frame;
  frame.poses[mandible_body].t = {10, 0, -20};
  renderer.update(frame);
  const Blob moved = blob_of(renderer.picture(front_camera(), settings));
  // The patient's left is on the right of a front view; 2 pixels a millimetre.
  EXPECT_NEAR(moved.centre.x() - rest.centre.x(), 20, 0.2);
  EXPECT_NEAR(moved.centre.y() - rest.centre.y(), 40, 0.2);
  settings.part_opacity = {{"mandible", 0.0}};
  const Blob skull = blob_of(renderer.picture(front_camera(), settings));
  EXPECT_NEAR(skull.centre.y(), 100 - 60, 0.2);
  EXPECT_NEAR(skull.centre.x(), 100, 0.2);
}

TEST_F(Scene, BodiesAreDrawnWhereTheFrameHasThem) {
  std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 30}, 5)),
                             make_part("mandible", Role::mandible, ball({0, 0, -30}, 5)),
                             make_part("graft", Role::transplant, ball({-10, 0, 0}, 8)),
                             make_part("piece", Role::segment, ball({10, 0, 0}, 8))};
  const BodyTree bodies = test::bodies_for(parts, {{"piece", mandible_body}});
  SceneRenderer renderer(parts);
  FrameState frame;
  frame.poses[mandible_body].t = {0, 0, -6};
  frame.poses = completed(bodies, frame.poses);
  const auto place = [&](const std::string& part) {
    auto settings = mask_settings();
    for (const auto& other : parts) settings.part_opacity[other.name] = other.name == part;
    return blob_of(renderer.picture(front_camera(), settings)).centre;
  };
  renderer.update(frame);
  const Eigen::Vector2d graft = place("graft"), piece = place("piece");
  EXPECT_NEAR(graft.y(), 100, 0.2);
  EXPECT_NEAR(piece.y(), 112, 0.2);  // 2 pixels a millimetre
  frame.poses[BodyId{2}].t = {0, 0, 20};
  frame.poses[BodyId{3}] = {Eigen::Quaterniond::Identity(), {5, 0, 0}};
  renderer.update(frame);
  EXPECT_NEAR(place("graft").y(), 60, 0.2);
  EXPECT_NEAR(place("graft").x(), graft.x(), 0.2);
  EXPECT_NEAR(place("piece").x(), piece.x() + 10, 0.2);
  EXPECT_NEAR(place("piece").y(), 100, 0.2);
  // Far outside the rest box it is still within the picture's depth, and lit.
  frame.poses[BodyId{2}].t = {0, -200, 0};
  renderer.update(frame);
  auto settings = mask_settings();
  for (const auto& other : parts) settings.part_opacity[other.name] = other.name == "graft";
  const Image image = renderer.picture(front_camera(), settings);
  const Blob near = blob_of(image);
  EXPECT_GT(near.area, 2.2 * std::numbers::pi * 16 * 16);
  EXPECT_GT(pixel(image, static_cast<int>(near.centre.x()), static_cast<int>(near.centre.y())).g,
            90);
}

TEST_F(Scene, FreePartsLeaveNoBakedShadeBehind) {
  std::vector<Part> with = {make_part("skull", Role::skull, ball({0, 0, 0}, 20)),
                            make_part("frame", Role::skull, ball({0, -60, 30}, 4)),
                            make_part("graft", Role::transplant, ball({0, -24, 0}, 6))};
  test::bodies_for(with);
  const std::vector<Part> without = {with[0], with[1]};
  SceneRenderer both(with), bare(without);
  FrameState frame;
  frame.poses[BodyId{2}].t = {300, 0, 0};  // out of the picture
  both.update(frame);
  auto settings = mask_settings();
  settings.shadows = false;  // their map is laid around everything
  EXPECT_TRUE(test::same_bytes(both.picture(front_camera(), settings),
                               bare.picture(front_camera(), settings)));
}

TEST_F(Scene, TheFaceFollowsTheFrame) {
  const std::vector<Part> parts = {make_part("face", Role::face, ball({0, 0, 0}, 15))};
  SceneRenderer renderer(parts);
  FrameState frame;
  for (const auto& v : parts[0].mesh.vertices)
    frame.face.push_back((v + Eigen::Vector3d(0, 0, 10)).cast<float>());
  renderer.update(frame);
  const Blob moved = blob_of(renderer.picture(front_camera(), mask_settings()));
  EXPECT_NEAR(moved.centre.y(), 100 - 20, 0.2);
  renderer.update(FrameState{});  // a frame without a face shows it at rest
  const Blob rest = blob_of(renderer.picture(front_camera(), mask_settings()));
  EXPECT_NEAR(rest.centre.y(), 100, 0.2);
}

TEST_F(Scene, TransparentBackgroundIsEmptyOutsideAndStraightAtTheEdge) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  const Image image = renderer.picture(front_camera(), mask_settings());
  EXPECT_EQ(pixel(image, 3, 3).a, 0);
  EXPECT_EQ(pixel(image, 100, 100).a, 255);
  int edges = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Pixel p = pixel(image, x, y);
      if (p.a == 0) {
        EXPECT_EQ(p.r + p.g + p.b, 0);
      }
      if (p.a == 0 || p.a == 255) continue;
      ++edges;
      // Straight alpha: an edge pixel has the bone's own brightness, not one mixed with black.
      if (x < 100 && y < 100) {
        EXPECT_GT(p.r, 110) << x << ' ' << y << " alpha " << p.a;
      }
    }
  EXPECT_GT(edges, 50);
}

TEST_F(Scene, AnOpenShellIsDrawnFromBothSides) {
  TriMesh square;
  square.vertices = {{-20, 0, -20}, {20, 0, -20}, {20, 0, 20}, {-20, 0, 20}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};  // outward toward -y
  const std::vector<Part> parts = {make_part("maxilla", Role::maxilla, square)};
  SceneRenderer renderer(parts);
  const auto front = renderer.picture(front_camera(), mask_settings());
  const auto back = renderer.picture(turned(front_camera(), std::numbers::pi), mask_settings());
  EXPECT_NEAR(blob_of(front).area, 80 * 80, 80);
  EXPECT_NEAR(blob_of(back).area, 80 * 80, 80);
  EXPECT_NEAR(pixel(front, 100, 100).r, pixel(back, 100, 100).r, 12);
}

TEST_F(Scene, SliversOfSkinThatTurnOverShowNoneOfItsInnerSide) {
  TriMesh smooth = ball({0, 0, 0}, 40, 60);  // open behind
  std::erase_if(smooth.triangles, [&](const Eigen::Vector3i& t) {
    return smooth.vertices[static_cast<std::size_t>(t[0])].y() > 25;
  });
  // The first edge of every other triangle is split, and a sliver fills the slit.
  TriMesh split = smooth, slivers;
  split.triangles.clear();
  std::vector<Eigen::Vector3f> moved;
  for (const auto& v : smooth.vertices) moved.push_back(v.cast<float>());
  for (std::size_t i = 0; i < smooth.triangles.size(); ++i) {
    const Eigen::Vector3i& t = smooth.triangles[i];
    if (i % 2 == 0) {
      split.triangles.push_back(t);
      continue;
    }
    const auto &a = smooth.vertices[t[0]], &b = smooth.vertices[t[1]], &c = smooth.vertices[t[2]];
    const int middle = static_cast<int>(split.vertices.size());
    split.vertices.push_back(0.5 * (a + b) + 1e-3 * (c - a));
    moved.push_back((0.5 * (a + b) - 1e-3 * (c - a)).cast<float>());
    split.triangles.insert(split.triangles.end(), {{t[0], middle, t[2]}, {middle, t[1], t[2]}});
    slivers.triangles.push_back({t[0], t[1], middle});
  }
  TriMesh filled = split;
  filled.triangles.insert(filled.triangles.end(), slivers.triangles.begin(),
                          slivers.triangles.end());
  ASSERT_GT(slivers.triangles.size(), 1000u);
  const auto picture = [&](const TriMesh& mesh, int samples, double opacity) {
    const std::vector<Part> parts = {make_part("face", Role::face, mesh)};
    SceneRenderer renderer(parts);
    FrameState frame;
    frame.face = moved;
    renderer.update(frame);
    PictureSettings settings;
    settings.width = settings.height = 600;
    settings.samples = samples;
    settings.skin_opacity = opacity;
    return renderer.picture(front_camera(), settings);
  };
  for (const int samples : {1, 4})
    for (const double opacity : {1.0, 0.4})
      EXPECT_TRUE(test::alike(test::Picture(picture(filled, samples, opacity)),
                              test::Picture(picture(split, samples, opacity)), 0,
                              test::Region{150, 150, 300, 300}))
          << samples << " samples, opacity " << opacity;
}

/// A ball of skin of one colour up to `border_x`, of another beyond it, from the front.
Image skin_of_two_colours(const Eigen::Vector3f& before, const Eigen::Vector3f& beyond,
                          double border_x, int side) {
  TriMesh head = ball({0, 0, 0}, 40, 60);
  for (const auto& v : head.vertices) head.colors.push_back(v.x() > border_x ? beyond : before);
  const std::vector<Part> parts = {make_part("face", Role::face, head)};
  PictureSettings settings;
  settings.width = settings.height = side;
  return SceneRenderer(parts).picture(front_camera(), settings);
}

TEST_F(Scene, HairIsDullAndDarkSkinIsNot) {
  const Eigen::Vector3f fair(0.85f, 0.66f, 0.56f);
  const auto brightest = [](const Eigen::Vector3f& dark, const Eigen::Vector3f& elsewhere) {
    const Image image = skin_of_two_colours(dark, elsewhere, -14, 300);
    int most = 0;
    for (int y = 0; y < 300; ++y)  // of the dark part, off its blurred border
      for (int x = 60; x < 100; ++x) most = std::max(most, pixel(image, x, y).r);
    return most;
  };
  for (const Eigen::Vector3f& dark : {Eigen::Vector3f(0.30f, 0.22f, 0.17f), {0.35f, 0.22f, 0.15f}})
    EXPECT_LT(brightest(dark, fair), brightest(dark, dark) - 20) << dark.transpose();
}

TEST_F(Scene, HairCutShortHasAGrainAndBrownSkinHasNone) {
  const auto grain = [](const Eigen::Vector3f& colour, const Eigen::Vector3f& elsewhere) {
    const Image image = skin_of_two_colours(colour, elsewhere, -5, 600);
    int sum = 0;
    for (int y = 250; y < 350; ++y)
      for (int x = 170; x < 230; ++x)
        sum += std::abs(pixel(image, x, y).g - pixel(image, x + 1, y).g);
    return sum;
  };
  const Eigen::Vector3f fair(0.80f, 0.62f, 0.53f), shaven(0.51f, 0.42f, 0.38f);
  const Eigen::Vector3f brown(0.51f, 0.36f, 0.28f);
  EXPECT_GT(grain(shaven, fair), 1.5 * grain(shaven, shaven));
  EXPECT_LT(grain(brown, fair), 1.2 * grain(brown, brown));
}

TEST_F(Scene, ContactsAreMarkedInVermilionAndCanBeSwitchedOff) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  FrameState frame;
  frame.contacts.pairs.emplace_back();
  frame.contacts.pairs[0].contacts.push_back({{0, -30, 0}, {0, 0, 1}});
  renderer.update(frame);
  PictureSettings settings;
  settings.width = settings.height = 400;
  const auto vermilion = [&] {
    const Image image = renderer.picture(front_camera(), settings);
    int count = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Pixel p = pixel(image, x, y);
        count += p.r > 150 && p.g < 0.6 * p.r && p.b < 40;
      }
    return count;
  };
  EXPECT_GT(vermilion(), 12);
  settings.contacts = false;
  EXPECT_EQ(vermilion(), 0);
}

TEST_F(Scene, ShadowsDarkenOnlyWhatIsShaded) {
  // A small ball between the key light, up on the viewer's left, and a large one.
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30)),
                                   make_part("maxilla", Role::maxilla, ball({-26, -34, 32}, 8))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  settings.shadows = false;
  const Image lit = renderer.picture(front_camera(120), settings);
  settings.shadows = true;
  const Image shaded = renderer.picture(front_camera(120), settings);
  int darker = 0, brighter = 0, ball_pixels = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const int before = pixel(lit, x, y).r, after = pixel(shaded, x, y).r;
      ball_pixels += before > 120;
      darker += after < before - 25;
      brighter += after > before + 2;
    }
  EXPECT_GT(darker, 100);
  EXPECT_EQ(brighter, 0);
  EXPECT_LT(darker, ball_pixels / 3);  // no acne over the lit side
}

TEST_F(Scene, WhereTheSkyIsNoLongerSeenNoPixelIsLost) {
  // What lies in the second ball, which is not drawn, is completely shaded.
  TriMesh askew = ball({0, 0, 0}, 30);
  const Eigen::Quaterniond turned = Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2).normalized();
  for (auto& p : askew.vertices) p = turned * p;
  const std::vector<Part> parts = {make_part("skull", Role::skull, askew),
                                   make_part("maxilla", Role::maxilla, ball({9, -18, 6}, 20))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 700;
  settings.part_opacity = {{"maxilla", 0}};
  settings.shadows = false;
  const Image image = renderer.picture(front_camera(70), settings);
  const auto light = [&](int x, int y) {
    const Pixel p = pixel(image, x, y);
    return p.r + p.g + p.b;
  };
  int lost = 0, bone = 0;
  for (int y = 2; y + 2 < image.height; ++y)
    for (int x = 2; x + 2 < image.width; ++x) {
      const int around =
          std::min({light(x - 2, y), light(x + 2, y), light(x, y - 2), light(x, y + 2)});
      lost += light(x, y) < 0.85 * around;
      bone += pixel(image, x, y).r > pixel(image, x, y).b + 10;
    }
  EXPECT_EQ(lost, 0);
  EXPECT_GT(bone, 100000);
}

TEST_F(Scene, FourSamplesApproximateSupersampling) {
  const std::vector<Part> parts = {make_part("face", Role::face, ball({4, 0, 9}, 30)),
                                   make_part("mandible", Role::mandible, ball({-9, -25, -8}, 22))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  const Image sampled = renderer.picture(front_camera(), settings);
  settings.samples = 1;
  const Image plain = renderer.picture(front_camera(), settings);
  settings.supersampling = 4;
  const Image best = renderer.picture(front_camera(), settings);
  const double unsampled = difference(test::Picture(plain), test::Picture(best));
  EXPECT_GT(unsampled, 0);
  EXPECT_TRUE(test::alike(sampled, best, std::min(0.5 * unsampled, 0.005)));
}

TEST_F(Scene, MarksOnASurfaceAreVisibleFromFarOff) {
  const std::vector<Part> parts = {make_part("mandible", Role::mandible, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  FrameState moved;
  moved.poses[mandible_body].t = {0, 0, 0.01};
  renderer.update(moved);
  PictureSettings settings;
  settings.width = settings.height = 300;
  settings.samples = 1;
  settings.shadows = false;
  settings.wireframe = {"*"};
  settings.ghost = Ghost{};
  Camera camera = front_camera();
  camera.distance_mm = 6000;
  camera.field_of_view_deg *= 500.0 / 6000;
  const Image kept = renderer.picture(camera, settings);
  // What might be cut is lit as it is drawn.
  settings.clip = {.point = {0, 0, 900}, .normal = {0, 0, 1}};
  const Image direct = renderer.picture(camera, settings);
  EXPECT_TRUE(test::alike(kept, direct, 0.01));
  settings.wireframe.clear();
  const Image bare = renderer.picture(camera, settings);
  EXPECT_TRUE(test::unlike(kept, bare, 0.05));
}

TEST_F(Scene, WhatIsThinnerThanAPixelShowsNothingOfThePictureBefore) {
  TriMesh needle = ball({0, 0, 0}, 30, 12);
  for (auto& p : needle.vertices) p = {0.002 * p.x() + 0.1 * p.z(), 0.002 * p.y(), p.z()};
  const std::vector<Part> parts = {make_part("mandible", Role::mandible, needle),
                                   make_part("skull", Role::skull, ball({0, 0, 0}, 35))};
  PictureSettings both, thin;
  both.width = both.height = thin.width = thin.height = 200;
  thin.part_opacity = {{"skull", 0}};
  SceneRenderer used(parts), fresh(parts);
  used.picture(front_camera(), both);
  const Image after = used.picture(front_camera(), thin),
              alone = fresh.picture(front_camera(), thin);
  EXPECT_TRUE(test::same_bytes(after, alone));
  thin.part_opacity["mandible"] = 0;
  EXPECT_TRUE(test::unlike(fresh.picture(front_camera(), thin), alone, 0));  // it is seen
}

TEST_F(Scene, APictureBeyondTheDriversLimitIsRefusedInWords) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.width = 1 << 20;
  EXPECT_THROW(renderer.picture(front_camera(), settings), MachineError);
  settings.width = 64;
  EXPECT_EQ(renderer.picture(front_camera(), settings).width, 64);
}

}  // namespace
}  // namespace condyle
