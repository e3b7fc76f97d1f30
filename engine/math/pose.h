#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace condyle {

/// Rigid pose X_AB of frame B in frame A: p_A = R p_B + t. `R` is kept at unit length. mm.
struct Pose {
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return R * p + t; }
  /// X_AC = X_AB * X_BC
  Pose operator*(const Pose& b) const { return {(R * b.R).normalized(), R * b.t + t}; }
  Pose inverse() const { return {R.conjugate(), -(R.conjugate() * t)}; }
};

/// Rotation angle of the pose, rad, in [0, pi].
double rotation_angle(const Pose& pose);

/// Pose at the fraction s between `a` and `b`: rotation by slerp, and the point `pivot` (given in
/// the moving body's coordinates) along a straight line.
Pose interpolate(const Pose& a, const Pose& b, double s,
                 const Eigen::Vector3d& pivot = Eigen::Vector3d::Zero());

}  // namespace condyle
