#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "render/gpu_mesh.h"
#include "render/material.h"
#include "sim/frame/part.h"

namespace condyle {

/// A part ready to be drawn.
struct Drawable {
  const Part* part;
  Material material;
  bool closed;  // its back is never seen
  GpuMesh mesh;
  Eigen::Vector3f centre;  // of its box at rest, mm
};

/// Uploads the parts with their normals, colours, baked ambient occlusion and curvature.
std::vector<Drawable> make_drawables(std::span<const Part> parts);

}  // namespace condyle
