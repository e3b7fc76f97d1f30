#pragma once

#include <string>
#include <vector>

#include "render/image/image.h"
#include "sim/operation/operation.h"

namespace condyle {

struct SegmentPictureSettings {
  std::string title;
  std::vector<std::string> views = {"front", "three-quarter", "left"};  // standard ones
  std::vector<std::string> lines = {};                                  // below the pictures
};

/// One sheet: the bones and teeth from each view, before the operation with the segments in colours
/// at the uncut rest, and after it at the planned positions, with their outlines of before as
/// ghosts. Cut faces have the colour of spongy bone. Needs a current OpenGL context.
Image segment_sheet(const Operated& operated, const SegmentPictureSettings& settings);

}  // namespace condyle
