#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "render/scene/drawable.h"

namespace condyle {

/// Bends the tongues of a scene, in pictures alone, see TongueBend.
class TongueShape {
 public:
  /// Sends those whose pose has changed since the last call. poses: of each drawable.
  void send(std::span<Drawable> drawables, std::span<const Pose> poses);

 private:
  std::vector<Pose> sent_;                // by drawable; first: at rest
  std::vector<Eigen::Vector3f> normals_;  // reused between frames
};

}  // namespace condyle
