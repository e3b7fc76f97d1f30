#include "render/window/picture/image_texture.h"

#include <string>

#include "engine/core/error.h"

namespace condyle {

void ImageTexture::upload(int width, int height, const std::uint8_t* rgba) {
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  if (width == width_ && height == height_) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
  } else {
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (width > most || height > most)
      throw MachineError("the graphics driver cannot show a picture of " + std::to_string(width) +
                         "x" + std::to_string(height) + " (at most " + std::to_string(most) +
                         " a side); make the window smaller");
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    // Translucent skin leaves its alpha in the picture: replaced by 1, or the desktop would show.
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_A, GL_ONE);
    width_ = width;
    height_ = height;
  }
  glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace condyle
