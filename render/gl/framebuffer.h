#pragma once

#include "render/gl/gl_objects.h"
#include "render/image/drawn_box.h"
#include "render/image/image.h"

namespace condyle {

/// throws: MachineError when the newly bound framebuffer is incomplete.
void require_complete(int width, int height);

/// Largest sample count of multisampling in the context; 1: none.
int max_samples();
/// Largest picture that the driver of the current context draws, in pixels per side.
int max_side();

/// Off-screen colour (RGBA, 8 bit), depth and stencil, with or without multisampling.
class Framebuffer {
 public:
  /// `samples` is lowered to max_samples().
  /// throws: MachineError when the size exceeds the driver's limit or memory.
  Framebuffer(int width, int height, int samples);

  void bind() const;
  int width() const { return width_; }
  int height() const { return height_; }
  int samples() const { return samples_; }
  GLuint name() const { return framebuffer_; }

  /// Copies the picture, or a part of it, to another framebuffer of the same size (0 is the
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

/// A square depth texture for shadows, sampled with comparison. Beyond its edge the edge values
/// apply, where nothing should be.
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
