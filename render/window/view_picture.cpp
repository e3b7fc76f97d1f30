#include "render/window/view_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "render/framebuffer.h"
#include "render/smoothing.h"

namespace condyle {
namespace {

// Of the best quality, drawn without a break: about a tenth of a second without a GPU.
constexpr double pixels_at_once = 1.2e6;

/// What is smoothed: a picture as a texture.
struct RawPicture {
  GlTexture texture;
  GlFramebuffer framebuffer;
  int width = 0, height = 0;

  void fit(int w, int h) {
    if (width == w && height == h) return;
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, w, h, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glBindTexture(GL_TEXTURE_2D, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    width = w;
    height = h;
  }
};

}  // namespace

struct ViewPicture::State {
  std::optional<Framebuffer> drawn, finished;
  int samples_wanted = 0;
  RawPicture raw;  // only while there is no multisampling
  EdgeSmoothing smoothing;

  void fit(int w, int h, int samples) {
    if (!drawn || drawn->width() != w || drawn->height() != h || samples_wanted != samples) {
      drawn.reset();  // the old memory first
      drawn.emplace(w, h, samples);
      samples_wanted = samples;
    }
    if (!finished || finished->width() != w || finished->height() != h) {
      finished.reset();
      finished.emplace(w, h, 1);
    }
    if (samples <= 1) raw.fit(w, h);
  }
};

ViewPicture::ViewPicture() : state_(std::make_unique<State>()) {}
ViewPicture::~ViewPicture() = default;

std::optional<DrawnPicture> ViewPicture::draw(SceneRenderer& renderer, const PictureOrder& order,
                                              const std::function<bool()>& given_up) {
  const auto start = std::chrono::steady_clock::now();
  const Quality& quality = order.quality;
  PictureSettings settings = order.settings;
  const auto side = [&](int full) {
    return std::max(1, static_cast<int>(std::lround(full * quality.render_scale)));
  };
  settings.width = side(settings.width);
  settings.height = side(settings.height);
  settings.samples = quality.samples;
  settings.shadows = settings.shadows && quality.shadows;
  state_->fit(settings.width, settings.height, quality.samples);
  const auto draw_part = [&](double from_x, double to_x) {
    settings.from_x = from_x;
    settings.to_x = to_x;
    state_->drawn->bind();
    renderer.draw(order.camera, settings);
    glFinish();
  };
  if (order.beside && order.frame) {
    renderer.update(*order.beside);
    draw_part(0, order.wipe_at);
    renderer.update(*order.frame);
    draw_part(order.wipe_at, 1);
  } else {
    const double pixels = static_cast<double>(settings.width) * settings.height;
    const int columns = given_up && !order.moving && quality.samples > 1
                            ? static_cast<int>(std::ceil(pixels / pixels_at_once))
                            : 1;
    for (int i = 0; i < columns; ++i) {
      if (i > 0 && given_up()) return std::nullopt;
      draw_part(static_cast<double>(i) / columns, static_cast<double>(i + 1) / columns);
    }
  }
  if (quality.samples > 1) {
    state_->drawn->resolve_to(state_->finished->name());
  } else {
    state_->drawn->resolve_to(state_->raw.framebuffer);
    state_->finished->bind();
    state_->smoothing.draw(state_->raw.texture, settings.width, settings.height);
  }
  DrawnPicture picture{.width = settings.width,
                       .height = settings.height,
                       .parts = order.parts,
                       .quality = quality,
                       .samples = std::max(1, state_->drawn->samples()),
                       .moving = order.moving};
  picture.rgba.resize(std::size_t{4} * static_cast<std::size_t>(settings.width) *
                      static_cast<std::size_t>(settings.height));
  state_->finished->bind();
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, settings.width, settings.height, GL_RGBA, GL_UNSIGNED_BYTE,
               picture.rgba.data());
  picture.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return picture;
}

}  // namespace condyle
