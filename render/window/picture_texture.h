#pragma once

#include "render/gl_objects.h"
#include "render/window/picture_order.h"

namespace condyle {

/// The last 3-D picture as a texture of the window's context, so that panels can be drawn anew
/// without it.
class PictureTexture {
 public:
  /// Takes the pixels over.
  void show(const DrawnPicture& picture);
  /// GL texture, its first row at the bottom, opaque.
  unsigned name() const { return texture_; }
  /// Whom it shows; none before the first.
  const std::shared_ptr<const DrawnParts>& parts() const { return parts_; }

 private:
  GlTexture texture_;
  int width_ = 0, height_ = 0;
  std::shared_ptr<const DrawnParts> parts_;
};

}  // namespace condyle
