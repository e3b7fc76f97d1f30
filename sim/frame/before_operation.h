#pragma once

#include <string>
#include <vector>

#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// The patient before an operation, as the operated one is drawn.
struct BeforeOperation {
  FrameState frame = {};                // all bodies where they were, and the face as it was
  std::vector<Part> removed = {};       // resected bone with its teeth and gums, of the cranium
  std::vector<std::string> added = {};  // parts that were not there: grafts
};

}  // namespace condyle
