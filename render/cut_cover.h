#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

/// Triangles that close every rim of a surface, each by a fan from one of its vertices: with them
/// it goes round each place a whole number of times, so that a cut through it has an inside. They
/// are not for being seen.
std::vector<Eigen::Vector3i> cover_rims(std::span<const Eigen::Vector3i> triangles);

}  // namespace condyle
