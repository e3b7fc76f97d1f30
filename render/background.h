#pragma once

#include <cstdint>
#include <vector>

#include "render/backdrop.h"
#include "render/gl_objects.h"

namespace condyle {

/// What is seen where nothing is.
class Background {
 public:
  Background();

  /// Fills what is empty of the framebuffer that is bound, of this size: where its depths are as
  /// cleared.
  void draw(int width, int height, Backdrop shade);

  /// A whole picture of it, RGBA, rows from the bottom; made once for each size and shade.
  const std::vector<std::uint8_t>& picture(int width, int height, Backdrop shade);

 private:
  GlProgram program_;
  GlVertexArray no_attributes_;
  int width_ = 0, height_ = 0;
  Backdrop shade_ = Backdrop::dark;
  std::vector<std::uint8_t> picture_;
};

}  // namespace condyle
