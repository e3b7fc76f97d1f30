#include <algorithm>

#include "render/gl/framebuffer.h"
#include "render/image/smoothing.h"
#include "render/scene/background.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using DrawnBoxes = WithContext;

std::vector<Part> two_balls() {
  return {make_part("mandible", Role::mandible, ball({20, 0, -10}, 12)),
          make_part("skull", Role::skull, ball({-5, 10, 5}, 15))};
}

/// The whole picture drawn, resolved and smoothed, without a known box.
Image whole(SceneRenderer& renderer, const Camera& camera, const PictureSettings& settings) {
  const int w = settings.width, h = settings.height;
  const Framebuffer drawn(w, h, settings.samples), resolved(w, h, 1);
  drawn.bind();
  renderer.draw(camera, settings);
  drawn.resolve_to(resolved.name());
  Image image = resolved.read();
  if (!settings.smooth_edges) return image;
  // As they are read from the card: rows from the bottom.
  const auto turned_over = [&](const std::vector<std::uint8_t>& rgba) {
    std::vector<std::uint8_t> rows;
    const auto stride = std::ptrdiff_t{4} * w;
    for (int y = h - 1; y >= 0; --y)
      rows.insert(rows.end(), rgba.begin() + stride * y, rgba.begin() + stride * (y + 1));
    return rows;
  };
  std::vector<std::uint8_t> smoothed;
  smooth_edges(turned_over(image.rgba), w, h, {0, 0, w, h}, smoothed);
  image.rgba = turned_over(smoothed);
  return image;
}

void expect_whole(SceneRenderer& renderer, const Camera& camera, PictureSettings settings,
                  bool smaller) {
  settings.width = 300;
  settings.height = 220;
  const DrawnBox box = renderer.drawn_box(camera, settings);
  EXPECT_EQ(box.width() * box.height() < 300 * 220 / 2, smaller);
  for (const int samples : {1, 4})
    for (const bool smooth : {false, true}) {
      if (samples > 1 && smooth) continue;
      settings.samples = samples;
      settings.smooth_edges = smooth;
      Image expected = whole(renderer, camera, settings);
      for (std::size_t i = 3; i < expected.rgba.size(); i += 4) expected.rgba[i] = 255;
      EXPECT_TRUE(test::same_bytes(renderer.picture(camera, settings), expected))
          << samples << " samples, smooth " << smooth;
    }
}

TEST_F(DrawnBoxes, WorkOnlyWhereSomethingIsDrawnChangesNoPixel) {
  const auto parts = two_balls();
  SceneRenderer renderer(parts);
  expect_whole(renderer, front_camera(220), {}, true);
  expect_whole(renderer, front_camera(40), {}, false);  // beyond the picture's edges
}

TEST_F(DrawnBoxes, HoldLinesDotsAndContacts) {
  const auto parts = two_balls();
  SceneRenderer renderer(parts);
  LineSet lines;
  lines.ends = {{-50, 0, 40}, {-30, 0, 45}};
  lines.dots = {{40, 0, 30}};
  lines.width_px = 14;
  lines.dot_mm = 3;
  renderer.set_lines("path", lines);
  FrameState frame;
  frame.contacts.pairs.emplace_back();
  frame.contacts.pairs.back().contacts.emplace_back();
  frame.contacts.pairs.back().contacts.back().point = {-10, 0, -40};
  renderer.update(frame);
  expect_whole(renderer, front_camera(260), {}, true);
}

TEST_F(DrawnBoxes, HoldGhostsAndWireframes) {
  const auto parts = two_balls();
  SceneRenderer renderer(parts);
  FrameState frame;
  frame.poses[mandible_body].t = {-60, 0, 30};
  renderer.update(frame);
  PictureSettings settings;
  settings.ghost.emplace();
  settings.wireframe = {"*"};
  expect_whole(renderer, front_camera(300), settings, true);
}

TEST_F(DrawnBoxes, AreEmptyWithNothingToDraw) {
  const auto parts = two_balls();
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.part_opacity = {{"mandible", 0}, {"skull", 0}};
  settings.width = 64;
  settings.height = 48;
  EXPECT_TRUE(renderer.drawn_box(front_camera(), settings).empty());
  const Image image = renderer.picture(front_camera(), settings);
  const auto background = Background().picture(64, 48, Backdrop::dark);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      EXPECT_EQ(pixel(image, x, y).g, background[4 * ((47 - y) * 64 + x) + 1]);
}

}  // namespace
}  // namespace condyle
