#include "render/window/view_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "render/framebuffer.h"
#include "render/scene_renderer.h"
#include "render/smoothing.h"

namespace condyle {

namespace {

/// A texture that can be drawn into.
struct Canvas {
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
    // Translucent skin leaves its alpha behind; behind it is the background, not the desktop.
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_A, GL_ONE);
    glBindTexture(GL_TEXTURE_2D, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw MachineError("the graphics driver cannot keep a picture of " + std::to_string(w) + "x" +
                         std::to_string(h) + "; make the window smaller");
    width = w;
    height = h;
  }
};

}  // namespace

struct ViewPicture::State {
  std::optional<Framebuffer> drawn;
  int samples_wanted = 0;
  Canvas raw;       // before smoothing; only while there is no multisampling
  Canvas finished;  // what is shown
  EdgeSmoothing smoothing;

  void fit(int w, int h, int samples) {
    finished.fit(w, h);
    if (samples <= 1) raw.fit(w, h);
    if (drawn && drawn->width() == w && drawn->height() == h && samples_wanted == samples) return;
    drawn.reset();  // the old memory first
    drawn.emplace(w, h, samples);
    samples_wanted = samples;
  }
};

ViewPicture::ViewPicture() : state_(std::make_unique<State>()) {}
ViewPicture::~ViewPicture() = default;

double ViewPicture::draw(SceneRenderer& renderer, const Camera& camera, PictureSettings settings,
                         const Quality& quality, const std::optional<Wipe>& wipe) {
  const auto start = std::chrono::steady_clock::now();
  const auto side = [&](int full) {
    return std::max(1, static_cast<int>(std::lround(full * quality.render_scale)));
  };
  settings.width = side(settings.width);
  settings.height = side(settings.height);
  settings.samples = quality.samples;
  settings.shadows = settings.shadows && quality.shadows;
  state_->fit(settings.width, settings.height, quality.samples);
  state_->drawn->bind();
  if (wipe) {
    PictureSettings left = settings;
    left.to_x = settings.from_x = wipe->at;
    renderer.update(*wipe->left);
    renderer.draw(camera, left);
    renderer.update(*wipe->right);
  }
  renderer.draw(camera, settings);
  if (quality.samples > 1) {
    state_->drawn->resolve_to(state_->finished.framebuffer);
  } else {
    state_->drawn->resolve_to(state_->raw.framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, state_->finished.framebuffer);
    state_->smoothing.draw(state_->raw.texture, settings.width, settings.height);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glFinish();  // or the time taken would be found in the next call
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

unsigned ViewPicture::texture() const {
  return state_->finished.width ? state_->finished.texture : 0u;
}
int ViewPicture::samples() const { return state_->drawn ? state_->drawn->samples() : 0; }

}  // namespace condyle
