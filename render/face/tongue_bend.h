#pragma once

#include <Eigen/Geometry>

#include "engine/math/pose.h"

namespace condyle {

/// Shape of the tongue while the jaw moves, for pictures alone: its tip stays with the mandible,
/// its root goes with the hyoid, which moves half as far as the mandible and descends a little.
/// So the tongue lies further forward in the arch the wider the jaw opens. The constants were
/// chosen to leave room between mandible and hyoid.
class TongueBend {
 public:
  /// tongue: its bounds at rest, mm, in the frame of the mandible. X_CM: pose of the mandible.
  TongueBend(const Eigen::AlignedBox3f& tongue, const Pose& X_CM);

  /// Place in the cranium's frame of a point of tongue, root or hyoid, given at rest.
  Eigen::Vector3f operator()(const Eigen::Vector3f& rest) const;
  /// Pose of the hyoid.
  const Eigen::Affine3f& hyoid() const { return hyoid_; }

 private:
  Eigen::AlignedBox3f tongue_;
  Eigen::Affine3f mandible_, hyoid_;
};

}  // namespace condyle
