#pragma once

#include <Eigen/Core>
#include <array>

namespace condyle {

using Triangle = std::array<Eigen::Vector3d, 3>;

/// Nearest points of two triangles. `squared_mm2` is 0 exactly when they cross or touch (to 1e-12
/// mm); then `p` and `q` are a common point.
struct TriangleGap {
  double squared_mm2 = 0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  // on a
  Eigen::Vector3d q = Eigen::Vector3d::Zero();  // on b
};

/// Exact distance of two triangles, also when edges are parallel or a triangle has no area. Results
/// not below `bound_mm2` may be returned as `bound_mm2` without points.
TriangleGap triangle_distance(const Triangle& a, const Triangle& b, double bound_mm2);

/// Point of the triangle nearest to p.
Eigen::Vector3d nearest_point(const Eigen::Vector3d& p, const Triangle& t);

/// Intersection of two triangles: the two ends of the common segment.
struct TriangleCrossing {
  bool crosses = false;
  double apart_mm = 0;  // lower bound of their distance
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
};
TriangleCrossing triangle_crossing(const Triangle& a, const Triangle& b);

/// Length of the shortest translation that separates two crossing triangles, mm (separating axes:
/// both face normals and the nine edge pairs).
double triangle_overlap(const Triangle& a, const Triangle& b);

}  // namespace condyle
