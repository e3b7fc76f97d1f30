#include "render/window/input/camera_control.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;

// `up` of a camera without roll. Defined at the poles too, where the direction alone is not enough.
Vector3d level_up(const CameraAngles& a) {
  return {-std::sin(a.elevation) * std::sin(a.azimuth), std::sin(a.elevation) * std::cos(a.azimuth),
          std::cos(a.elevation)};
}

Vector3d direction_of(const CameraAngles& a) {
  return {std::cos(a.elevation) * std::sin(a.azimuth), -std::cos(a.elevation) * std::cos(a.azimuth),
          std::sin(a.elevation)};
}

double zoomed(double distance_mm, double factor, const ZoomLimits& limits) {
  return std::clamp(distance_mm * factor, limits.nearest_mm, limits.farthest_mm);
}

}  // namespace

CameraDrag drag_of(const DragKeys& keys) {
  if (keys.middle) return CameraDrag::pan;
  if (keys.right) return CameraDrag::zoom;
  if (!keys.left) return CameraDrag::none;
  if (keys.ctrl) return CameraDrag::roll;
  return keys.shift ? CameraDrag::pan : CameraDrag::orbit;
}

Eigen::Matrix3d picture_axes(const Camera& camera) {
  const Vector3d toward = camera.direction.normalized();
  Vector3d right = camera.up.cross(toward);
  // `up` along the direction is undetermined: take any right.
  if (right.norm() < 1e-9) right = toward.unitOrthogonal();
  right.normalize();
  Eigen::Matrix3d axes;
  axes << right.transpose(), toward.cross(right).transpose(), toward.transpose();
  return axes;
}

CameraAngles camera_angles(const Camera& camera) {
  const Eigen::Matrix3d axes = picture_axes(camera);
  const Vector3d up = axes.row(1), toward = axes.row(2);
  CameraAngles angles;
  angles.elevation = std::asin(std::clamp(toward.z(), -1.0, 1.0));
  if (std::hypot(toward.x(), toward.y()) > 1e-6) {
    angles.azimuth = std::atan2(toward.x(), -toward.y());
  } else {
    // At a pole the picture's up direction defines the azimuth, and the roll is 0.
    const double side = toward.z() > 0 ? -1 : 1;
    angles.azimuth = std::atan2(side * up.x(), -side * up.y());
  }
  const Vector3d level = level_up(angles);
  angles.roll = std::atan2(level.cross(up).dot(toward), level.dot(up));
  return angles;
}

Camera with_angles(Camera camera, const CameraAngles& angles) {
  camera.direction = direction_of(angles);
  camera.up = Eigen::AngleAxisd(angles.roll, camera.direction) * level_up(angles);
  return camera;
}

double pixel_mm(const Camera& camera, const ViewRect& view) {
  return 2 * camera.distance_mm * std::tan(camera.field_of_view_deg * pi / 360) / view.height;
}

Camera dragged(const Camera& camera, CameraDrag drag, const Vector2d& from, const Vector2d& to,
               const ViewRect& view, const ZoomLimits& limits) {
  const Vector2d delta = to - from;
  Camera result = camera;
  switch (drag) {
    case CameraDrag::none:
      break;
    case CameraDrag::orbit: {
      CameraAngles angles = camera_angles(camera);
      const double gain = pi / view.height;  // half a turn over the height of the view
      // In a rolled picture the mouse's path is rotated back, so that the surface still follows it.
      const double c = std::cos(angles.roll), s = std::sin(angles.roll);
      angles.azimuth -= gain * (c * delta.x() + s * delta.y());
      angles.elevation =
          std::clamp(angles.elevation + gain * (c * delta.y() - s * delta.x()), -pi / 2, pi / 2);
      result = with_angles(camera, angles);
      break;
    }
    case CameraDrag::pan: {
      const Eigen::Matrix3d axes = picture_axes(camera);
      const Vector3d right = axes.row(0), up = axes.row(1);
      result.target += pixel_mm(camera, view) * (delta.y() * up - delta.x() * right);
      break;
    }
    case CameraDrag::zoom:
      result.distance_mm =
          zoomed(camera.distance_mm, std::exp(delta.y() * 2.5 / view.height), limits);
      break;
    case CameraDrag::roll: {
      const Vector2d centre(view.x + view.width / 2, view.y + view.height / 2);
      const Vector2d a = from - centre, b = to - centre;
      if (a.norm() < 1 || b.norm() < 1) break;
      // The picture turns with the mouse: clockwise on the screen, where y points down.
      const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      CameraAngles angles = camera_angles(camera);
      angles.roll += turn;
      result = with_angles(camera, angles);
      break;
    }
  }
  return result;
}

Camera wheeled(const Camera& camera, double clicks, const Vector2d& mouse, const ViewRect& view,
               const ZoomLimits& limits) {
  Camera result = camera;
  result.distance_mm = zoomed(camera.distance_mm, std::exp(-0.12 * clicks), limits);
  const Eigen::Matrix3d axes = picture_axes(camera);
  const Vector3d right = axes.row(0), up = axes.row(1);
  const Vector2d offset = mouse - Vector2d(view.x + view.width / 2, view.y + view.height / 2);
  const double shift = pixel_mm(camera, view) * (1 - result.distance_mm / camera.distance_mm);
  result.target += shift * (offset.x() * right - offset.y() * up);
  return result;
}

}  // namespace condyle
