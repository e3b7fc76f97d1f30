#include "tools/picture_facts.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/framebuffer.h"
#include "render/scene_renderer.h"

namespace condyle {

std::string PictureFacts::shortfall() const {
  if (samples >= samples_asked) return {};
  return fmt::format(
      "asked for {} samples a pixel, the graphics driver ({}) gives {}: edges in the pictures are "
      "less smooth",
      samples_asked, driver, samples);
}

PictureFacts usual_picture_facts(const OffscreenContext& context) {
  const int asked = PictureSettings{}.samples;
  return {context.description(), asked, std::min(asked, most_samples())};
}

}  // namespace condyle
