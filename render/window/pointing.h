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
  std::span<const float> values;
};

/// The nearest surface under the mouse, and its value there, between those of the triangle's
/// corners; infinite where one of them is.
struct PointedValue {
  std::size_t surface = 0;
  float value = 0;
};

/// `mouse`: pixels, like `view`. Looks at every triangle: some milliseconds for 200k.
std::optional<PointedValue> pointed_value(const Camera& camera, const ViewRect& view,
                                          const Eigen::Vector2d& mouse,
                                          std::span<const PointedSurface> surfaces);

}  // namespace condyle
