#include "render/arch_view.h"

#include <Eigen/Geometry>

namespace condyle {
namespace {

/// The jaw that a part belongs to or rides on.
Body jaw_of(const Part& part) {
  const Body body = body_of(part.role);
  return body == Body::free ? part.carrier : body;
}

}  // namespace

ArchView::ArchView(const std::string& camera, std::span<const Part> parts, double aspect)
    : body_(camera == lower ? Body::mandible : Body::cranium) {
  const bool is_lower = body_ == Body::mandible;
  Eigen::AlignedBox3d teeth, jaw;
  for (const auto& part : parts) {
    if (jaw_of(part) != body_ || part.role == Role::eyes || part.role == Role::tongue) {
      hidden_[part.name] = 0;
      continue;
    }
    for (const auto& v : part.mesh.vertices) {
      if (is_teeth(part.role)) teeth.extend(v);
      if (part.role == (is_lower ? Role::mandible : Role::maxilla) ||
          (!is_lower && part.role == Role::skull))
        jaw.extend(v);
    }
  }
  const auto& box = teeth.isEmpty() ? jaw : teeth;
  const Eigen::Vector3d low = box.isEmpty() ? Eigen::Vector3d::Zero() : box.min(),
                        high = box.isEmpty() ? Eigen::Vector3d::Ones() : box.max();
  camera_ = standard_camera(is_lower ? "above" : "below", low, high, aspect);
  if (is_lower) camera_.up = {0, 1, 0};
}

Camera ArchView::at(const FrameState& frame) const {
  if (body_ != Body::mandible) return camera_;
  Camera moved = camera_;
  moved.target = frame.X_CM * camera_.target;
  moved.direction = frame.X_CM.R * camera_.direction;
  moved.up = frame.X_CM.R * camera_.up;
  return moved;
}

}  // namespace condyle
