#pragma once

#include <vector>

#include "render/camera.h"

namespace condyle {

/// A camera that goes from view to view, slowing down at each.
struct CameraPath {
  struct Key {
    double at = 0;  // share of the recording, 0 to 1; rising
    Camera camera;
  };
  std::vector<Key> keys;  // one at least

  /// Between two views the eye turns about the point it looks at by the shortest way; before the
  /// first and after the last it stands still.
  Camera at(double share) const;
};

}  // namespace condyle
