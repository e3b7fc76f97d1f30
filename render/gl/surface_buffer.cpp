#include "render/gl/surface_buffer.h"

#include <cstdint>

#include "render/gl/framebuffer.h"

namespace condyle {
namespace {

constexpr std::int64_t max_pixels = 1 << 24;  // 28 bytes each

void make_texture(GLuint texture, GLint kept_as, GLenum format, GLenum type, int width,
                  int height) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, kept_as, width, height, 0, format, type, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
}

void attach(GLenum point, GLuint texture) {
  glFramebufferTexture2D(GL_FRAMEBUFFER, point, GL_TEXTURE_2D, texture, 0);
}

}  // namespace

bool SurfaceBuffer::fits(int width, int height) {
  GLint max_side = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_side);
  return width <= max_side && height <= max_side &&
         static_cast<std::int64_t>(width) * height <= max_pixels;
}

void SurfaceBuffer::fit(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = height_ = 0;
  while (glGetError() != GL_NO_ERROR) {
  }
  make_texture(words_, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, width, height);
  make_texture(away_, GL_R32F, GL_RED, GL_FLOAT, width, height);
  make_texture(lit_, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, width, height);
  make_texture(depth_, GL_DEPTH24_STENCIL8, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, width, height);
  const auto finish = [&] {
    attach(GL_DEPTH_STENCIL_ATTACHMENT, depth_);
    require_complete(width, height);
  };
  glBindFramebuffer(GL_FRAMEBUFFER, surfaces_);
  attach(GL_COLOR_ATTACHMENT0, words_);
  attach(GL_COLOR_ATTACHMENT1, away_);
  const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, both);
  finish();
  glBindFramebuffer(GL_FRAMEBUFFER, light_);
  attach(GL_COLOR_ATTACHMENT0, lit_);
  finish();
  width_ = width;
  height_ = height;
}

void SurfaceBuffer::begin_surfaces(const DrawnBox& box) {
  glBindFramebuffer(GL_FRAMEBUFFER, surfaces_);
  glScissor(box.x0, box.y0, box.width(), box.height());
  glStencilMask(0xff);
  const GLfloat farthest[] = {1e30f, 1e30f, 1e30f, 1e30f};
  glClearBufferfv(GL_COLOR, 1, farthest);
  glClearBufferfi(GL_DEPTH_STENCIL, 0, 1, 0);
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
}

void SurfaceBuffer::number_surface(int number) const { glStencilFunc(GL_ALWAYS, number, 0xff); }

void SurfaceBuffer::begin_light() {
  glBindFramebuffer(GL_FRAMEBUFFER, light_);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
}

void SurfaceBuffer::clear_light(const DrawnBox& box) const {
  glScissor(box.x0, box.y0, box.width(), box.height());
  constexpr GLfloat none[] = {0, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, none);
}

void SurfaceBuffer::light(int number, const DrawnBox& box) const {
  glScissor(box.x0, box.y0, box.width(), box.height());
  glStencilFunc(GL_EQUAL, number, 0xff);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void SurfaceBuffer::begin_edges() {
  if (!marked_) marked_.emplace();
  glBindFramebuffer(GL_FRAMEBUFFER, marked_->target);
  if (marked_->width == width_ && marked_->height == height_) return;
  make_texture(marked_->edges, GL_R8, GL_RED, GL_UNSIGNED_BYTE, width_, height_);
  attach(GL_COLOR_ATTACHMENT0, marked_->edges);
  require_complete(width_, height_);
  marked_->width = width_;
  marked_->height = height_;
}

void SurfaceBuffer::end() const {
  glDisable(GL_STENCIL_TEST);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace condyle
