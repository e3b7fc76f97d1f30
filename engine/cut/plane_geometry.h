#pragma once

#include <Eigen/Core>

namespace condyle {

/// Twice the area of a triangle in the plane; positive if it runs counter-clockwise.
inline double double_area(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                          const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

}  // namespace condyle
