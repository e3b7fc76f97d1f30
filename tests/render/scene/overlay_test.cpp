// Cuts and overlays in pictures.
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numbers>

#include "engine/core/error.h"
#include "render/camera/camera_path.h"
#include "render/image/raster_2d.h"
#include "render/mesh/cut_cover.h"
#include "render/mesh/vertex_normals.h"
#include "tests/render/scene_fixture.h"
#include "tests/support/program.h"

namespace condyle {
namespace {

using Overlays = WithContext;

Part skull_ball() { return make_part("skull", Role::skull, ball({0, 0, 0}, 30)); }

int count(const Image& image, const std::function<bool(const Pixel&)>& is) {
  int found = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) found += is(pixel(image, x, y));
  return found;
}

TEST_F(Overlays, AClippingPlaneLeavesHalfAndTheCapClosesIt) {
  const std::vector<Part> parts = {skull_ball()};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.shadows = false;
  const double whole = blob_of(renderer.picture(front_camera(), settings)).area;
  // All beyond x = 0 to the patient's left, right in a front view, is removed.
  settings.clip = {.point = {0, 0, 0}, .normal = {2, 0, 0}};
  const Blob half = blob_of(renderer.picture(front_camera(), settings));
  EXPECT_NEAR(half.area, whole / 2, 0.01 * whole);
  EXPECT_LT(half.centre.x(), 90);
  // Cut across the line of sight, the capped ball shows one flat disc of the cut's colour: of the
  // radius of the ball there.
  settings.clip = {.point = {0, -18, 0}, .normal = {0, -1, 0}};
  const Image capped = renderer.picture(front_camera(), settings);
  const Pixel middle = pixel(capped, 100, 100);
  const int flat = count(capped, [&](const Pixel& p) {
    return p.a == 255 && std::abs(p.r - middle.r) < 3 && std::abs(p.g - middle.g) < 3;
  });
  const double radius = 200 / 100.0 * 24 * 500 / 482;
  EXPECT_NEAR(flat, std::numbers::pi * radius * radius, 0.03 * std::numbers::pi * radius * radius);
  // Without caps, the inner side has the same colour: nothing looks hollow.
  settings.clip->capped = false;
  const Pixel open = pixel(renderer.picture(front_camera(), settings), 100, 100);
  EXPECT_NEAR(open.r, middle.r, 3);
  EXPECT_NEAR(open.b, middle.b, 3);
  // From behind, the cap is hidden by the ball itself.
  settings.clip->capped = true;
  const Camera back = turned(front_camera(), std::numbers::pi);
  const Image behind = renderer.picture(back, settings);
  settings.clip.reset();
  EXPECT_EQ(pixel(behind, 100, 100).r, pixel(renderer.picture(back, settings), 100, 100).r);
}

TEST_F(Overlays, OnlyNamedPartsAreCutAndACavityStaysOpen) {
  // A ball with a cavity: a shell, and a tooth in the cavity that is spared.
  TriMesh shell = ball({0, 0, 0}, 30);
  const TriMesh inner = ball({0, 0, 0}, 20);
  const int first = static_cast<int>(shell.vertices.size());
  shell.vertices.insert(shell.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  for (const auto& t : inner.triangles)
    shell.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  const std::vector<Part> parts = {make_part("skull", Role::skull, shell),
                                   make_part("teeth", Role::upper_teeth, ball({0, 0, 0}, 5))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.shadows = false;
  settings.clip = {.point = {0, 0, 0}, .normal = {0, -1, 0}, .parts = {"skull"}};
  const Image image = renderer.picture(front_camera(), settings);
  const Pixel wall = pixel(image, 150, 100), cavity = pixel(image, 130, 100),
              tooth = pixel(image, 97, 97);
  EXPECT_GT(wall.r, cavity.r + 20);
  EXPECT_GT(tooth.b, wall.b + 20);  // whole: seen from its front
  settings.clip->parts = {"teeth"};
  EXPECT_EQ(pixel(renderer.picture(front_camera(), settings), 100, 50).a, 255);
}

TEST_F(Overlays, AnOpenSurfaceIsCappedAcrossItsRim) {
  // A ball without its top: its rim is covered for the winding number.
  TriMesh bowl = ball({0, 0, 0}, 30);
  std::erase_if(bowl.triangles, [&](const Eigen::Vector3i& t) {
    return (bowl.vertices[t[0]] + bowl.vertices[t[1]] + bowl.vertices[t[2]]).z() / 3 > 22;
  });
  ASSERT_FALSE(is_closed_surface(bowl.triangles));
  auto closed = bowl.triangles;
  const auto cover = cover_rims(bowl.triangles);
  ASSERT_FALSE(cover.empty());
  closed.insert(closed.end(), cover.begin(), cover.end());
  EXPECT_TRUE(is_closed_surface(closed));
  EXPECT_TRUE(cover_rims(closed).empty());

  const std::vector<Part> parts = {make_part("skull", Role::skull, bowl)};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.clip = {.point = {0, 0, 0}, .normal = {0, -1, 0}};
  const Image image = renderer.picture(front_camera(), settings);
  EXPECT_EQ(pixel(image, 100, 100).a, 255);
  EXPECT_EQ(pixel(image, 100, 60).a, 255);
  EXPECT_EQ(pixel(image, 100, 45).a, 0);  // above the rim
  EXPECT_NEAR(pixel(image, 70, 100).r, pixel(image, 130, 110).r, 2);
}

TEST_F(Overlays, ACutAwayOpensTheSkinAndNothingElse) {
  const std::vector<Part> parts = {skull_ball(),
                                   make_part("face", Role::face, ball({0, 0, 0}, 35))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  settings.shadows = false;
  const Image whole = renderer.picture(front_camera(), settings);
  settings.cut_away = {.center = {0, -35, 0}, .radius_mm = 12};
  const Image opened = renderer.picture(front_camera(), settings);
  EXPECT_GT(pixel(opened, 100, 100).b, pixel(whole, 100, 100).b + 15);  // bone, not skin
  int changed = 0, outside = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      if (std::abs(pixel(opened, x, y).b - pixel(whole, x, y).b) <= 6) continue;
      ++changed;
      outside += std::hypot(x - 100, y - 100) > 30;
    }
  EXPECT_GT(changed, std::numbers::pi * 20 * 20);
  EXPECT_LE(outside, 4);  // its inner side is drawn now: a pixel of it at the outline
}

TEST_F(Overlays, AGhostMarksThePartsRestPositionUntilItReturns) {
  const std::vector<Part> parts = {make_part("mandible", Role::mandible, ball({0, 0, 0}, 15)),
                                   make_part("skull", Role::skull, ball({0, 0, 40}, 5))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  const Image rest = renderer.picture(front_camera(), settings);
  settings.ghost.emplace();
  EXPECT_TRUE(test::same_bytes(rest, renderer.picture(front_camera(), settings)));
  FrameState frame;
  frame.poses[mandible_body].t = {0, 0, -35};
  renderer.update(frame);
  const Image moved = renderer.picture(front_camera(), settings);
  const Pixel ghost = pixel(moved, 100, 100);
  EXPECT_GT(ghost.a, 20);
  EXPECT_LT(ghost.a, 200);
  EXPECT_GT(ghost.b, ghost.r + 30);
  settings.ghost.reset();
  EXPECT_EQ(pixel(renderer.picture(front_camera(), settings), 100, 100).a, 0);
}

TEST_F(Overlays, SkinLeavesItsGhostOnlyWhereItHasMoved) {
  const std::vector<Part> parts = {make_part("face", Role::face, ball({0, 0, 0}, 30))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  settings.shadows = false;
  FrameState frame;  // the patient's left has moved in by 4 mm
  for (const auto& v : parts[0].mesh.vertices)
    frame.face.push_back((v * (v.x() > 5 ? 26.0 / 30 : 1)).cast<float>());
  renderer.update(frame);
  const Image plain = renderer.picture(front_camera(), settings);
  settings.ghost.emplace();
  const Image ghost = renderer.picture(front_camera(), settings);
  const auto changed = [&](int x, int y) {
    const Pixel a = pixel(plain, x, y), b = pixel(ghost, x, y);
    return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
  };
  for (int y = 60; y <= 140; y += 4) {
    for (int x = 60; x <= 100; x += 4) EXPECT_EQ(changed(x, y), 0) << x << ' ' << y;
    EXPECT_GT(changed(130, y), 10) << y;
  }
}

// A head that is open in front, as at the mouth, with a round window in its side.
TEST_F(Overlays, AWindowInTheSkinChangesNothingThatIsSeenThroughTheMouth) {
  Part face = make_part("face", Role::face, ball({0, 0, 0}, 30));
  std::erase_if(face.mesh.triangles, [&](const Eigen::Vector3i& t) {
    const Eigen::Vector3d& v = face.mesh.vertices[static_cast<std::size_t>(t[0])];
    return v.y() < 0 && std::hypot(v.x(), v.z()) < 10;
  });
  const std::vector<Part> parts = {face};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  settings.shadows = false;
  const Image whole = renderer.picture(front_camera(), settings);
  settings.cut_away = {.center = {20, -22, 0}, .radius_mm = 8};
  const Image opened = renderer.picture(front_camera(), settings);
  for (int y = 90; y <= 110; y += 4)
    for (int x = 90; x <= 104; x += 2) EXPECT_EQ(pixel(opened, x, y).r, pixel(whole, x, y).r);
  const Pixel flesh = pixel(opened, 142, 100), skin = pixel(whole, 142, 100);
  EXPECT_GT(std::abs(flesh.g - skin.g), 8);
  EXPECT_GT(flesh.r, 2 * pixel(opened, 100, 100).r);  // not the dark of a mouth
}

TEST_F(Overlays, WireframesDrawTheEdgesOfTheNamedPart) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({-20, 0, 0}, 15, 8)),
                                   make_part("maxilla", Role::maxilla, ball({20, 0, 0}, 15, 8))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  const Image plain = renderer.picture(front_camera(), settings);
  settings.wireframe = {"maxilla"};
  const Image lined = renderer.picture(front_camera(), settings);
  int left = 0, right = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x)
      if (pixel(lined, x, y).r < pixel(plain, x, y).r - 30) ++(x < 100 ? left : right);
  EXPECT_EQ(left, 0);
  EXPECT_GT(right, 150);
}

TEST_F(Overlays, AWireframeLeavesTheShapeVisibleHoweverFineItIs) {
  PictureSettings settings;
  settings.width = settings.height = 200;
  settings.shadows = false;
  for (const int rings : {12, 48, 160}) {
    const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30, rings))};
    SceneRenderer renderer(parts);
    settings.wireframe.clear();
    const Image plain = renderer.picture(front_camera(), settings);
    settings.wireframe = {"*"};
    const Image lined = renderer.picture(front_camera(), settings);
    double before = 0, after = 0;
    int darker = 0, count = 0;
    for (int y = 80; y < 120; ++y)
      for (int x = 80; x < 120; ++x) {
        before += pixel(plain, x, y).r;
        after += pixel(lined, x, y).r;
        darker += pixel(lined, x, y).r < pixel(plain, x, y).r - 8;
        ++count;
      }
    EXPECT_GT(after, 0.5 * before) << rings << " rings";
    EXPECT_GT(darker, 0.05 * count) << "lines are seen with " << rings << " rings";
  }
}

TEST_F(Overlays, AWireframeIsHiddenByWhatHidesItsPart) {
  // Hardly a millimetre below the skin, as cheek and chin have it.
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 29, 24)),
                                   make_part("face", Role::face, ball({0, 0, 0}, 30, 48))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 300;
  settings.shadows = false;
  const Image plain = renderer.picture(front_camera(), settings);
  settings.wireframe = {"skull"};
  EXPECT_TRUE(test::same_bytes(plain, renderer.picture(front_camera(), settings)));
  settings.skin_opacity = 0;
  EXPECT_TRUE(test::unlike(plain, renderer.picture(front_camera(), settings), 0));
}

TEST_F(Overlays, LinesHaveTheirWidthWhereverTheyAreAndShowThroughFaintly) {
  const std::vector<Part> parts = {skull_ball()};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  const Image bare = renderer.picture(front_camera(), settings);
  LineSet lines{.color = {0, 1, 0}, .width_px = 6 * 1080 / 200.0f, .through = 0.5f};
  lines.ends = {{-45, 0, 0}, {45, 0, 0}};  // through the ball
  renderer.set_lines("test", lines);
  const Image drawn = renderer.picture(front_camera(), settings);
  const auto green = [](const Pixel& p) { return p.g > 200 && p.r < 60 && p.a > 200; };
  int rows = 0;
  for (int y = 80; y < 120; ++y) rows += green(pixel(drawn, 20, y));
  EXPECT_NEAR(rows, 6, 1);
  const Pixel inside = pixel(drawn, 100, 100), before = pixel(bare, 100, 100);
  EXPECT_LT(inside.r, before.r - 40);
  EXPECT_GT(inside.r, 40);
  renderer.set_lines("test", {});
  EXPECT_TRUE(test::same_bytes(bare, renderer.picture(front_camera(), settings)));
  // Farther off it is as wide.
  lines.ends = {{-50, 60, 36}, {50, 60, 36}};
  renderer.set_lines("test", lines);
  const Image far = renderer.picture(front_camera(), settings);
  int far_rows = 0;
  for (int y = 0; y < 80; ++y) far_rows += green(pixel(far, 100, y));
  EXPECT_NEAR(far_rows, 6, 1);
}

TEST_F(Overlays, BrightLinesHaveADarkBorderOnALightBackground) {
  const std::vector<Part> parts = {skull_ball()};
  SceneRenderer renderer(parts);
  LineSet lines{.color = {0.94f, 0.89f, 0.26f}, .width_px = 4 * 1080 / 200.0f};
  lines.ends = {{-45, 0, 40}, {45, 0, 40}};
  renderer.set_lines("test", lines);
  auto settings = mask_settings();
  const auto darkest = [&](Backdrop backdrop) {
    settings.backdrop = backdrop;
    const Image image = renderer.picture(front_camera(), settings);
    int yellow = 0, least = 255;
    for (int y = 10; y < 30; ++y) {
      const Pixel p = pixel(image, 100, y);
      yellow += p.r > 220 && p.b < 90;
      least = std::min(least, p.g);
    }
    EXPECT_NEAR(yellow, 4, 1);
    return least;
  };
  // Without a backdrop; only its border is around a line.
  const auto around = [&](Backdrop backdrop) {
    settings.backdrop = backdrop;
    settings.transparent = true;
    int dark = 0;
    const Image image = renderer.picture(front_camera(), settings);
    for (int y = 10; y < 30; ++y) {
      const Pixel p = pixel(image, 100, y);
      dark += p.a > 200 && p.g < 90;
    }
    return dark;
  };
  settings.transparent = false;
  EXPECT_LT(darkest(Backdrop::light), 90);
  EXPECT_GT(darkest(Backdrop::dark), 45) << "no darker than the background";
  EXPECT_GE(around(Backdrop::light), 2);
  EXPECT_EQ(around(Backdrop::dark), 0);
}

TEST_F(Overlays, PatchesColourOnlyWhereTheValueIsSmall) {
  const std::vector<Part> parts = {skull_ball()};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  const Image plain = renderer.picture(front_camera(), settings);
  renderer.set_colour_map(distance_colours());
  std::vector<float> values;
  for (const auto& v : parts[0].mesh.vertices) values.push_back(v.z() > 0 ? -0.5f : 1.f);
  renderer.color_part("skull", values);
  settings.mapped_up_to = 0.f;
  const Image patches = renderer.picture(front_camera(), settings);
  EXPECT_GT(pixel(patches, 100, 75).r, pixel(patches, 100, 75).b + 60);  // red: overlap
  EXPECT_EQ(pixel(patches, 100, 130).g, pixel(plain, 100, 130).g);       // bone as it is
  settings.mapped_up_to.reset();
  EXPECT_NE(pixel(renderer.picture(front_camera(), settings), 100, 130).g,
            pixel(plain, 100, 130).g);
}

TEST_F(Overlays, TwoStatesAreDrawnSideBySide) {
  const std::vector<Part> parts = {make_part("mandible", Role::mandible, ball({0, 0, 0}, 25))};
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = settings.height = 200;
  const Image rest = renderer.picture(front_camera(), settings);
  FrameState frame;
  frame.poses[mandible_body].t = {0, 0, -20};
  renderer.update(frame);
  const Image open = renderer.picture(front_camera(), settings);
  const Image both = wiped(rest, open, 0.5);
  for (const int y : {40, 100, 160}) {
    EXPECT_EQ(pixel(both, 80, y).g, pixel(rest, 80, y).g);
    EXPECT_EQ(pixel(both, 120, y).g, pixel(open, 120, y).g);
  }
  EXPECT_GT(pixel(both, 100, 10).g, 220) << "a light line on dark";
  EXPECT_LT(pixel(wiped(rest, open, 0.5, Backdrop::light), 100, 10).g, 80);
  // The window draws each state into its own part of one target.
  settings.from_x = 0.5;
  const Image right = renderer.picture(front_camera(), settings);
  EXPECT_EQ(pixel(right, 120, 100).g, pixel(open, 120, 100).g);
}

TEST_F(Overlays, SmoothEdgesAndSupersamplingSoftenStairs) {
  const std::vector<Part> parts = {skull_ball()};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.samples = 1;
  const auto soft = [&] {
    return count(renderer.picture(front_camera(), settings),
                 [](const Pixel& p) { return p.a > 20 && p.a < 235; });
  };
  EXPECT_EQ(soft(), 0);
  settings.smooth_edges = true;
  EXPECT_GT(soft(), 100);
  settings.smooth_edges = false;
  settings.supersampling = 3;
  EXPECT_GT(soft(), 200);
  const Image fine = renderer.picture(front_camera(), settings);
  EXPECT_EQ(fine.width, 200);
  settings.supersampling = 1;
  EXPECT_NEAR(blob_of(fine).area, blob_of(renderer.picture(front_camera(), settings)).area,
              0.01 * blob_of(fine).area);
}

TEST(CameraPath, StopsAtItsViewsAndTurnsBetweenThem) {
  Camera front, left = front;
  left.direction = {1, 0, 0};
  left.distance_mm = 150;
  const CameraPath path{{{0.2, front}, {0.8, left}}};
  EXPECT_EQ(path.at(0).direction, front.direction);
  EXPECT_EQ(path.at(1).distance_mm, 150);
  const Camera half = path.at(0.5);
  EXPECT_NEAR(half.direction.x(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(half.direction.norm(), 1, 1e-12);
  EXPECT_NEAR(half.distance_mm, 300, 1e-9);  // halfway of the ratio
  EXPECT_NEAR((half.up - front.up).norm(), 0, 1e-12);
  Camera back = front;
  back.direction = {0, 1, 0};
  const Camera between = CameraPath{{{0, front}, {1, back}}}.at(0.5);
  EXPECT_NEAR(between.direction.z(), 0, 1e-12);  // round the side, not over the head
  EXPECT_NEAR(between.direction.norm(), 1, 1e-12);
}

/// A ball as a body of fibres.
FibreBody fibre_ball(const Eigen::Vector3d& center, double radius) {
  const TriMesh mesh = ball(center, radius);
  FibreBody body;
  for (const auto& v : mesh.vertices) {
    body.positions.push_back(v.cast<float>());
    body.colors.emplace_back(0.1f, 0.4f, 0.6f);
    body.fibres.push_back(static_cast<float>(v.z() / 3));
  }
  body.triangles = mesh.triangles;
  return body;
}

TEST_F(Overlays, ABodyOfFibresIsHiddenByBoneAndStriped) {
  const std::vector<Part> parts = {skull_ball()};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.shadows = false;
  const Image bare = renderer.picture(front_camera(), settings);
  renderer.set_body("muscle", fibre_ball({0, 40, 0}, 20));
  EXPECT_EQ(renderer.picture(front_camera(), settings).rgba, bare.rgba) << "behind the bone";
  renderer.set_body("muscle", fibre_ball({0, -40, 0}, 20));
  const Image seen = renderer.picture(front_camera(), settings);
  const auto blue = [](const Pixel& p) { return p.b > p.r + 30; };
  EXPECT_GT(count(seen, blue), 3000);
  int rises = 0;  // of brightness, down the middle
  for (int y = 71; y < 130; ++y) rises += pixel(seen, 100, y).b > pixel(seen, 100, y - 1).b + 2;
  EXPECT_GT(rises, 5) << "no stripes";
  FibreBody faint = fibre_ball({0, -40, 0}, 20);
  faint.opacity = 0.3f;
  renderer.set_body("muscle", faint);
  const Pixel mixed = pixel(renderer.picture(front_camera(), settings), 100, 100);
  EXPECT_GT(mixed.r, pixel(seen, 100, 100).r + 30);
  renderer.set_body("muscle", {});
  EXPECT_EQ(renderer.picture(front_camera(), settings).rgba, bare.rgba);
}

TEST_F(Overlays, PiecesOfPartsAreStoredThoseOfOverlaysAreNot) {
  const test::Folder cache;
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before ? before : "";
  setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
  const auto stored = [&] {
    int files = 0;
    for (const auto& file : std::filesystem::directory_iterator(cache.path() / "condyle"))
      files += file.path().filename().string().starts_with("patches-");
    return files;
  };
  const std::vector<Part> parts = {skull_ball(),
                                   make_part("face", Role::face, ball({0, 0, 0}, 80))};
  SceneRenderer renderer(parts);
  const Image bare = renderer.picture(front_camera(), mask_settings());
  EXPECT_EQ(stored(), 2);
  for (const double forward_mm : {0, 5}) {
    FibreBody body = fibre_ball({0, -100 - forward_mm, 0}, 10);
    GlassSheet sheet;
    sheet.positions = body.positions;
    sheet.triangles = body.triangles;
    for (auto& p : sheet.positions) p.x() += 25;
    renderer.set_body("muscle", std::move(body));
    renderer.set_sheet("layer", sheet);
    EXPECT_NE(renderer.picture(front_camera(), mask_settings()).rgba, bare.rgba);
    renderer.set_body("muscle", {});
    renderer.set_sheet("layer", {});
  }
  EXPECT_EQ(stored(), 2);
  before ? setenv("XDG_CACHE_HOME", kept.c_str(), 1) : unsetenv("XDG_CACHE_HOME");
}

TEST_F(Overlays, ABodyOfFibresIsFaintThroughSkinAndCutWithEverything) {
  const std::vector<Part> parts = {make_part("face", Role::face, ball({0, 0, 0}, 40))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings();
  settings.shadows = false;
  const Pixel skin = pixel(renderer.picture(front_camera(), settings), 100, 100);
  renderer.set_body("muscle", fibre_ball({0, 0, 0}, 20));
  const Pixel through = pixel(renderer.picture(front_camera(), settings), 100, 100);
  EXPECT_LT(through.r, skin.r - 20);
  EXPECT_GT(through.r, skin.r / 3);
  settings.skin_opacity = 0;
  settings.clip = {.point = {0, 0, 0}, .normal = {1, 0, 0}};
  const Image half = renderer.picture(front_camera(), settings);
  EXPECT_EQ(pixel(half, 115, 100).a, 0);
  EXPECT_EQ(pixel(half, 85, 100).a, 255);
}

}  // namespace
}  // namespace condyle
