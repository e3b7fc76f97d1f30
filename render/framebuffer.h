#pragma once

#include "render/drawn_box.h"
#include "render/gl_objects.h"
#include "render/image.h"

namespace condyle {

/// throws: MachineError when the framebuffer that is bound, just made, cannot be drawn into.
void require_complete(int width, int height);

/// Of multisampling, that the context gives at most; 1: none.
int most_samples();
/// Pixels a side that the driver of the current context draws at most.
int most_side();

/// Colour (RGBA, 8 bit), depth and stencil off the screen, with or without multisampling.
class Framebuffer {
 public:
  /// `samples` is lowered to most_samples().
  /// throws: MachineError when the size is beyond the driver's limit or memory.
  Framebuffer(int width, int height, int samples);

  void bind() const;
  int width() const { return width_; }
  int height() const { return height_; }
  int samples() const { return samples_; }
  GLuint name() const { return framebuffer_; }

  /// Sends the picture, or a part of it, to another framebuffer of the same size (0 is the
  /// window's). Averages samples.
  void resolve_to(GLuint target) const;
  void resolve_to(GLuint target, const DrawnBox& box) const;
  /// Pixels, rows from the top. Only without multisampling.
  Image read() const;

 private:
  GlFramebuffer framebuffer_;
  GlRenderbuffer color_, depth_;
  int width_, height_, samples_;
};

/// A square depth picture for shadows, sampled with comparison. Beyond it goes on as at its edge,
/// where nothing should stand.
class DepthMap {
 public:
  explicit DepthMap(int side);
  void bind() const;
  int side() const { return side_; }
  GLuint texture() const { return depth_; }
  /// Binds it to a texture unit as plain depths, without comparison.
  void bind_depths(int unit) const;

 private:
  GlFramebuffer framebuffer_;
  GlTexture depth_;
  GlSampler plain_;
  int side_;
};

}  // namespace condyle
