#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "engine/math/pose.h"
#include "render/window/input/camera_control.h"

namespace condyle {

/// The handle by which a body is gripped: the body itself (moves in the plane of the picture), an
/// arrow along an axis, or a ring about one.
enum class Grip { body, left, back, up, turn_left, turn_back, turn_up };

/// Handles around a body's centre; their size on the screen does not depend on the zoom.
struct GizmoView {
  Camera camera;
  ViewRect view;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();    // in the cranium's frame, now
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns: left, back, up
  double arrow_px = 78, ring_px = 58;
};

/// A handle as a line on the screen, pixels. Arrows run from the centre to their tip.
struct GizmoHandle {
  Grip grip;
  std::vector<Eigen::Vector2d> line;
};
std::vector<GizmoHandle> gizmo_handles(const GizmoView& view);

/// The handle under the mouse: arrows before rings.
std::optional<Grip> grip_at(const GizmoView& view, const Eigen::Vector2d& mouse, double reach_px);

/// Pose of the body, in the cranium's frame, after the mouse has moved between two positions.
/// `view` and `start` are those at the moment of the grip.
Pose gripped(const GizmoView& view, Grip grip, const Pose& start, const Eigen::Vector2d& from,
             const Eigen::Vector2d& to);

/// Projects a point to the screen, pixels. It must lie in front of the eye.
Eigen::Vector2d screen_place(const Camera& camera, const ViewRect& view, const Eigen::Vector3d& p);

}  // namespace condyle
