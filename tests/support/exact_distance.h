// Distance of a point from a surface by trial of every triangle: the slow way, to check others by.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "engine/mesh/tri_mesh.h"

namespace condyle::test {

inline double segment_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                               const Eigen::Vector3d& b) {
  const double length2 = (b - a).squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0;
  return (a + t * (b - a) - p).norm();
}

inline double exact_distance(const Eigen::Vector3d& p, const TriMesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]],
                          &c = mesh.vertices[t[2]];
    least = std::min(
        {least, segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
    Eigen::Matrix3d frame;
    frame << b - a, c - a, (b - a).cross(c - a);
    const double area2 = frame.col(2).norm();
    if (area2 < 1e-12) continue;
    const Eigen::Vector3d weights = frame.inverse() * (p - a);
    if (weights.x() >= 0 && weights.y() >= 0 && weights.x() + weights.y() <= 1)
      least = std::min(least, std::abs(weights.z()) * area2);
  }
  return least;
}

}  // namespace condyle::test
