#pragma once

#include <cstdint>

#include "render/gl/gl_objects.h"

namespace condyle {

/// Opaque 8-bit RGBA pixels as a texture of the window's context.
class ImageTexture {
 public:
  /// Uploads the pixels. throws: MachineError for a picture larger than the driver allows.
  void upload(int width, int height, const std::uint8_t* rgba);
  /// GL texture, with the first row of the pixels at 0.
  unsigned name() const { return texture_; }

 private:
  GlTexture texture_;
  int width_ = 0, height_ = 0;
};

}  // namespace condyle
