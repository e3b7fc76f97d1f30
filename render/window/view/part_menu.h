#pragma once

#include <cstddef>

#include "render/window/view/measuring.h"

namespace condyle {

/// The menu of a part, opened by a click on it.
struct PartMenu {
  PinnedPoint point;    // that was clicked
  double x = 0, y = 0;  // on the screen, pixels
  bool shown = false;   // has been drawn

  std::size_t part() const { return point.part; }
};

}  // namespace condyle
