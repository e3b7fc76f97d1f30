#include "render/camera/arch_view.h"

#include <Eigen/Geometry>

namespace condyle {

ArchView::ArchView(const std::string& camera, std::span<const Part> parts, const BodyTree& bodies,
                   const JawBodies& jaw_bodies, double aspect)
    : body_(camera == lower ? jaw_bodies.lower_arch : jaw_bodies.upper_arch) {
  const bool is_lower = camera == lower;
  Eigen::AlignedBox3d teeth, jaw;
  for (const auto& part : parts) {
    const bool rides_on_lower = bodies.is_within(part.body, jaw_bodies.lower_arch);
    if (rides_on_lower != is_lower || !is_rigid(part.role) || part.role == Role::eyes ||
        part.role == Role::tongue) {
      hidden_[part.name] = 0;
      continue;
    }
    for (const auto& v : part.mesh.vertices) {
      if (is_teeth(part.role)) teeth.extend(v);
      if (part.role == (is_lower ? Role::mandible : Role::maxilla) || is_piece(part.role) ||
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
  const Pose& X_CB = frame.poses[body_];
  Camera moved = camera_;
  moved.target = X_CB * camera_.target;
  moved.direction = X_CB.R * camera_.direction;
  moved.up = X_CB.R * camera_.up;
  return moved;
}

}  // namespace condyle
