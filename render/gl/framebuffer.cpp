#include "render/gl/framebuffer.h"

#include <algorithm>
#include <cstring>

#include "engine/core/error.h"

namespace condyle {

void require_complete(int width, int height) {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE ||
      glGetError() == GL_OUT_OF_MEMORY)
    throw MachineError("the graphics driver cannot allocate a picture of " + std::to_string(width) +
                       "x" + std::to_string(height) + "; request a smaller one");
}

int max_samples() {
  GLint most = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  return std::max(1, most);
}

int max_side() {
  GLint most = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
  return most;
}

Framebuffer::Framebuffer(int width, int height, int samples)
    : width_(width), height_(height), samples_(samples) {
  const int most = max_side();
  if (width < 1 || height < 1 || width > most || height > most)
    throw MachineError("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                       " cannot be drawn; the graphics driver allows 1 to " + std::to_string(most) +
                       " pixels a side");
  samples = std::min(samples, max_samples());
  samples_ = samples <= 1 ? 0 : samples;
  while (glGetError() != GL_NO_ERROR) {
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glBindRenderbuffer(GL_RENDERBUFFER, color_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, GL_RGBA8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, GL_DEPTH24_STENCIL8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, depth_);
  require_complete(width, height);
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
}

void Framebuffer::resolve_to(GLuint target) const { resolve_to(target, {0, 0, width_, height_}); }

void Framebuffer::resolve_to(GLuint target, const DrawnBox& box) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target);
  glBlitFramebuffer(box.x0, box.y0, box.x1, box.y1, box.x0, box.y0, box.x1, box.y1,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
}

Image Framebuffer::read() const {
  Image image;
  image.width = width_;
  image.height = height_;
  const std::size_t stride = std::size_t{4} * width_;
  image.rgba.resize(stride * height_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  for (int top = 0, low = height_ - 1; top < low; ++top, --low)
    std::swap_ranges(image.rgba.begin() + static_cast<std::ptrdiff_t>(stride * top),
                     image.rgba.begin() + static_cast<std::ptrdiff_t>(stride * (top + 1)),
                     image.rgba.begin() + static_cast<std::ptrdiff_t>(stride * low));
  return image;
}

DepthMap::DepthMap(int side) : side_(side) {
  glBindTexture(GL_TEXTURE_2D, depth_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, side, side, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
               nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glSamplerParameteri(plain_, filter, GL_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glSamplerParameteri(plain_, wrap, GL_CLAMP_TO_EDGE);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  require_complete(side, side);
}

void DepthMap::bind_depths(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, depth_);
  glBindSampler(static_cast<GLuint>(unit), plain_);
}

void DepthMap::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, side_, side_);
}

}  // namespace condyle
