#include "render/window/picture/picture_texture.h"

namespace condyle {

void PictureTexture::show(const DrawnPicture& picture) {
  texture_.upload(picture.width, picture.height, picture.rgba.data());
  parts_ = picture.parts;
}

}  // namespace condyle
