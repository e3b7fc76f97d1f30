#pragma once

#include <string>

#include "render/gl/gl_context.h"

namespace condyle {

/// Renderer of the pictures.
struct RenderMetadata {
  std::string driver;  // all drivers used, where a recording was resumed with another
  int samples_asked = 1, samples = 1;  // per pixel

  /// Limitations due to the driver, as text; empty for none.
  std::string shortfall() const;
};

/// For pictures with default settings in the context, which must be current.
RenderMetadata default_render_metadata(const OffscreenContext& context);

}  // namespace condyle
