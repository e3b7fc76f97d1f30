#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "render/drawn_face.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// Where a patient's face is seen: a coarse one is drawn smooth, up to some millimetres from where
/// its vertices are. What is pointed at there is measured where it is, and marked where it is seen.
class SeenFace {
 public:
  explicit SeenFace(std::span<const Part> parts);
  /// Where its vertices would have to be, each along its normal, to lie on what is seen; none where
  /// it is seen as it is.
  std::vector<Eigen::Vector3f> places(const FrameState& frame) const;

 private:
  std::optional<DrawnFace> drawn_;
  std::vector<Eigen::Vector3f> rest_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace condyle
