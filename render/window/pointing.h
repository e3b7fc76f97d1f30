#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"
#include "render/camera.h"
#include "render/window/camera_control.h"

namespace condyle {

/// A surface that can be pointed at, with one value per vertex.
struct PointedSurface {
  const TriMesh* mesh;
  Pose X_WS;
  std::span<const float> values = {};
};

/// Where the mouse points at the nearest surface: its triangle, the shares of its corners there,
/// and the place, in the frame of the camera.
struct PointedPlace {
  std::size_t surface = 0;
  Eigen::Vector3i triangle = Eigen::Vector3i::Zero();
  Eigen::Vector3d shares = Eigen::Vector3d::Zero();
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

/// `mouse`: pixels, like `view`. Looks at every triangle: some milliseconds for 200k. Needs no
/// values.
std::optional<PointedPlace> pointed_place(const Camera& camera, const ViewRect& view,
                                          const Eigen::Vector2d& mouse,
                                          std::span<const PointedSurface> surfaces);

/// The nearest surface under the mouse, and its value there, between those of the triangle's
/// corners; infinite where one of them is.
struct PointedValue {
  std::size_t surface = 0;
  float value = 0;
};

std::optional<PointedValue> pointed_value(const Camera& camera, const ViewRect& view,
                                          const Eigen::Vector2d& mouse,
                                          std::span<const PointedSurface> surfaces);

}  // namespace condyle
