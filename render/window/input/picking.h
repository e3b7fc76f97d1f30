#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"
#include "render/camera/camera.h"
#include "render/window/input/camera_control.h"

namespace condyle {

/// A surface that can be picked, with one value per vertex.
struct PickableSurface {
  const TriMesh* mesh;
  Pose X_WS;
  std::span<const float> values = {};
};

/// The point of the nearest surface under the mouse: its triangle, the barycentric coordinates, and
/// the position in the frame of the camera.
struct PickedPoint {
  std::size_t surface = 0;
  Eigen::Vector3i triangle = Eigen::Vector3i::Zero();
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

/// `mouse`: pixels, like `view`. Tests every triangle: some milliseconds for 200k. Needs no
/// values.
std::optional<PickedPoint> pick_point(const Camera& camera, const ViewRect& view,
                                      const Eigen::Vector2d& mouse,
                                      std::span<const PickableSurface> surfaces);

/// The nearest surface under the mouse, and its interpolated value there; infinite where a corner's
/// value is.
struct PickedValue {
  std::size_t surface = 0;
  float value = 0;
};

std::optional<PickedValue> pick_value(const Camera& camera, const ViewRect& view,
                                      const Eigen::Vector2d& mouse,
                                      std::span<const PickableSurface> surfaces);

}  // namespace condyle
