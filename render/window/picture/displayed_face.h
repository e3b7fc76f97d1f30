#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "render/face/drawn_face.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// The face as displayed: a coarse one is drawn smooth, up to some millimetres from its vertices.
/// A picked point is measured on the mesh, and marked on the displayed surface.
class DisplayedFace {
 public:
  explicit DisplayedFace(std::span<const Part> parts);
  /// Its vertices projected along their normals onto the displayed surface; none where the mesh
  /// itself is displayed.
  std::vector<Eigen::Vector3f> places(const FrameState& frame) const;

 private:
  std::optional<DrawnFace> drawn_;
  std::vector<Eigen::Vector3f> rest_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace condyle
