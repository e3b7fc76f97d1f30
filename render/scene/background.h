#pragma once

#include <cstdint>
#include <vector>

#include "render/gl/gl_objects.h"
#include "render/image/backdrop.h"

namespace condyle {

/// Draws the background of a picture.
class Background {
 public:
  Background();

  /// Fills the empty pixels of the bound framebuffer, of this size: where its depths are cleared.
  void draw(int width, int height, Backdrop shade);
  /// Sets the uniforms of its colour in a program in use.
  static void set_in(GlProgram& program, int width, int height, Backdrop shade);

  /// A whole background picture, RGBA, rows from the bottom; cached for each size and shade.
  const std::vector<std::uint8_t>& picture(int width, int height, Backdrop shade);

 private:
  GlProgram program_;
  GlVertexArray no_attributes_;
  int width_ = 0, height_ = 0;
  Backdrop shade_ = Backdrop::dark;
  std::vector<std::uint8_t> picture_;
};

}  // namespace condyle
