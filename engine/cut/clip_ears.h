#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

/// Appends the triangles of a closed ring in the plane, counter-clockwise; corners may repeat where
/// a bridge joins a hole. Returns the number of ears that had to be cut though they overlap others.
int clip_ears(std::span<const Eigen::Vector2d> points, const std::vector<int>& ring,
              std::vector<Eigen::Vector3i>& triangles);

}  // namespace condyle
