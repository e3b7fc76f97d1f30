#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

/// Triangles that close every rim of a surface, each by a fan from one of its vertices: with them
/// its winding number is an integer at every point, so that a cut through it has an inside. They
/// are not displayed.
std::vector<Eigen::Vector3i> cover_rims(std::span<const Eigen::Vector3i> triangles);

}  // namespace condyle
