#pragma once

#include "render/window/picture/image_texture.h"
#include "render/window/picture/render_request.h"

namespace condyle {

/// The last 3-D picture as a texture of the window's context, so that panels can be redrawn
/// without it.
class PictureTexture {
 public:
  /// Uploads the pixels.
  void show(const DrawnPicture& picture);
  /// GL texture, its first row at the bottom, opaque.
  unsigned name() const { return texture_.name(); }
  /// The patient that it shows; none before the first picture.
  const std::shared_ptr<const DrawnParts>& parts() const { return parts_; }

 private:
  ImageTexture texture_;
  std::shared_ptr<const DrawnParts> parts_;
};

}  // namespace condyle
