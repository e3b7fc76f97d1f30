#pragma once

#include <Eigen/Core>

#include "render/camera/camera.h"

namespace condyle {

/// Effect of a mouse drag on the camera.
enum class CameraDrag { none, orbit, pan, zoom, roll };

/// The drag for the held buttons and keys: left orbits, middle or Shift+left pans, right zooms,
/// Ctrl+left rolls.
struct DragKeys {
  bool left = false, middle = false, right = false;
  bool shift = false, ctrl = false;
};
CameraDrag drag_of(const DragKeys& keys);

/// Position of the 3-D view in the window, pixels from the top left.
struct ViewRect {
  double x = 0, y = 0, width = 1, height = 1;
  bool contains(double px, double py) const {
    return px >= x && py >= y && px < x + width && py < y + height;
  }
};

/// Limits of the camera's distance, mm.
struct ZoomLimits {
  double nearest_mm = 20;
  double farthest_mm = 4000;
};

/// Camera as angles about the case's vertical: azimuth 0 looks from the front and grows toward the
/// patient's left, elevation is up, roll turns the picture clockwise. rad.
struct CameraAngles {
  double azimuth = 0, elevation = 0, roll = 0;
};
CameraAngles camera_angles(const Camera& camera);
/// The camera with these angles; target and distance stay. Its `up` is perpendicular to its
/// direction.
Camera with_angles(Camera camera, const CameraAngles& angles);

/// The camera after the mouse has moved between two positions, pixels. Orbit turns about the
/// vertical (the surface follows the mouse) and keeps target, distance and roll; pan moves the
/// target in the plane of the picture so that it stays under the mouse; zoom changes only the
/// distance; roll only the roll.
Camera dragged(const Camera& camera, CameraDrag drag, const Eigen::Vector2d& from,
               const Eigen::Vector2d& to, const ViewRect& view, const ZoomLimits& limits);

/// The camera after the wheel turned by `clicks` (up is nearer); the point under the mouse stays.
Camera wheeled(const Camera& camera, double clicks, const Eigen::Vector2d& mouse,
               const ViewRect& view, const ZoomLimits& limits);

/// Unit axes of the picture: right, up and toward the eye as rows.
Eigen::Matrix3d picture_axes(const Camera& camera);

/// Size of one pixel at the target, mm.
double pixel_mm(const Camera& camera, const ViewRect& view);

}  // namespace condyle
