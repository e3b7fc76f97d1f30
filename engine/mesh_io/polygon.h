#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

constexpr std::size_t max_polygon_corners = 1000;

/// Cuts a polygon into corners - 2 triangles with its own sense: a quad along the better diagonal,
/// others by clipping ears in the plane of their mean normal. Appended to `triangles`.
void triangulate(std::span<const int> corners, const std::vector<Eigen::Vector3d>& vertices,
                 std::vector<Eigen::Vector3i>& triangles);

}  // namespace condyle
