#include "render/window/picture/view_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "render/scene/picture_target.h"

namespace condyle {
namespace {

// Pixels of the best quality drawn at once: about 0.1 s without a GPU.
constexpr double pixels_at_once = 1.2e6;
// With four samples llvmpipe also draws into the pixels before the scissor's edge, where
// translucent surfaces would be drawn twice; not at the borders of its tiles.
constexpr int tile = 64;

}  // namespace

struct ViewPicture::State {
  PictureTarget target;
};

ViewPicture::ViewPicture() : state_(std::make_unique<State>()) {}
ViewPicture::~ViewPicture() = default;

std::optional<DrawnPicture> ViewPicture::draw(SceneRenderer& renderer, const RenderRequest& request,
                                              const std::function<void(bool beside)>& turn_to,
                                              const std::function<bool()>& given_up) {
  const auto start = std::chrono::steady_clock::now();
  const Quality& quality = request.quality;
  PictureSettings settings = request.settings;
  const auto side = [&](int full) {
    return std::max(1, static_cast<int>(std::lround(full * quality.render_scale)));
  };
  settings.width = side(settings.width);
  settings.height = side(settings.height);
  settings.samples = quality.samples;
  settings.coarse = quality.coarse;
  settings.shadows = settings.shadows && quality.shadows;
  auto& target = state_->target;
  target.fit(settings.width, settings.height, quality.samples, quality.samples <= 1);
  DrawnBox box = renderer.drawn_box(request.camera, settings);
  const auto draw_part = [&](double from_x, double to_x) {
    settings.from_x = from_x;
    settings.to_x = to_x;
    target.drawn().bind();
    renderer.draw(request.camera, settings, box);
    glFinish();
  };
  if (request.beside && request.frame) {
    // Both are drawn in the union of their boxes.
    turn_to(false);
    box = renderer.drawn_box(request.camera, settings);
    turn_to(true);
    settings.before_operation = request.before_is_beside;
    box = box.around(renderer.drawn_box(request.camera, settings));
    draw_part(0, request.wipe_at);
    turn_to(false);
    settings.before_operation = false;
    draw_part(request.wipe_at, 1);
  } else {
    const double pixels = static_cast<double>(settings.width) * settings.height;
    const int columns = given_up && !request.moving && quality.samples > 1
                            ? static_cast<int>(std::ceil(pixels / pixels_at_once))
                            : 1;
    const auto begin_of = [&](int i) {
      const int at = i < columns ? settings.width * i / columns / tile * tile : settings.width;
      return static_cast<double>(at) / settings.width;
    };
    for (int i = 0; i < columns; ++i) {
      if (i > 0 && given_up()) return std::nullopt;
      draw_part(begin_of(i), begin_of(i + 1));
    }
  }
  DrawnPicture picture{.width = settings.width,
                       .height = settings.height,
                       .parts = request.parts,
                       .quality = quality,
                       .samples = std::max(1, target.drawn().samples()),
                       .moving = request.moving,
                       .number = request.number};
  target.read(box, settings.backdrop, false, picture.rgba);
  picture.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return picture;
}

}  // namespace condyle
