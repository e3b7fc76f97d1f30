#include "engine/math/pose.h"

#include <cassert>
#include <cmath>

namespace condyle {

double rotation_angle(const Pose& pose) {
  return 2.0 * std::atan2(pose.R.vec().norm(), std::abs(pose.R.w()));
}

Pose interpolate(const Pose& a, const Pose& b, double s, const Eigen::Vector3d& pivot) {
  assert(std::abs(a.R.norm() - 1) < 1e-6 && std::abs(b.R.norm() - 1) < 1e-6);
  if (s <= 0.0) return a;
  if (s >= 1.0) return b;
  const Eigen::Quaterniond R = a.R.slerp(s, b.R).normalized();
  const Eigen::Vector3d p = (1.0 - s) * (a * pivot) + s * (b * pivot);
  return {R, p - R * pivot};
}

}  // namespace condyle
