#pragma once

#include <string>
#include <vector>

#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// A part that an operation removes, at rest.
struct RemovedPart {
  Part part = {};
  std::string shown_as = {};  // the part of the operated patient that is shown and hidden with it
};

/// The patient before an operation, as the operated one is drawn.
struct BeforeOperation {
  FrameState frame = {};                  // all bodies where they were, and the face as it was
  std::vector<RemovedPart> removed = {};  // resected bone with its teeth and gums
  std::vector<std::string> added = {};    // parts that were not there: grafts
};

}  // namespace condyle
