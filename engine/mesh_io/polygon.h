#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

constexpr std::size_t max_polygon_corners = 1000;

/// Triangulates a polygon with its own orientation: a quad along the better diagonal, others by ear
/// clipping in the plane of their mean normal. Appends corners - 2 triangles to `triangles`.
void triangulate(std::span<const int> corners, const std::vector<Eigen::Vector3d>& vertices,
                 std::vector<Eigen::Vector3i>& triangles);

}  // namespace condyle
