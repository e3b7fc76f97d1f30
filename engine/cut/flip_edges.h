#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

/// Flips inner edges of triangles in the plane until they are Delaunay (Lawson 1977), so that flat
/// triangles along straight outlines disappear. The outline's edges stay.
void flip_edges(std::span<const Eigen::Vector2d> points, std::vector<Eigen::Vector3i>& triangles);

}  // namespace condyle
