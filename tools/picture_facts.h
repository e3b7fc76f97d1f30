#pragma once

#include <string>

#include "render/gl_context.h"

namespace condyle {

/// What pictures are drawn with.
struct PictureFacts {
  std::string driver;  // all that have drawn, where a recording was resumed with another
  int samples_asked = 1, samples = 1;  // a pixel

  /// What they lack for want of the driver, in words; empty for nothing.
  std::string shortfall() const;
};

/// Of pictures with the usual settings that the context draws, which must be current.
PictureFacts usual_picture_facts(const OffscreenContext& context);

}  // namespace condyle
