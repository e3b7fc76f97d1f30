#pragma once

#include <vector>

#include "render/camera/camera.h"

namespace condyle {

/// A camera that moves from view to view, slowing down at each.
struct CameraPath {
  struct Key {
    double at = 0;  // fraction of the recording, 0 to 1; increasing
    Camera camera;
  };
  std::vector<Key> keys;  // at least one

  /// Between two views the eye rotates about its target along the shortest arc; before the first
  /// and after the last it is stationary.
  Camera at(double fraction) const;
};

}  // namespace condyle
