#include "render/recording/render_metadata.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/gl/framebuffer.h"
#include "render/scene/scene_renderer.h"

namespace condyle {

std::string RenderMetadata::shortfall() const {
  if (samples >= samples_asked) return {};
  return fmt::format(
      "requested {} samples per pixel, the graphics driver ({}) provides {}: edges in the pictures "
      "are "
      "less smooth",
      samples_asked, driver, samples);
}

RenderMetadata default_render_metadata(const OffscreenContext& context) {
  const int asked = PictureSettings{}.samples;
  return {context.description(), asked, std::min(asked, max_samples())};
}

}  // namespace condyle
