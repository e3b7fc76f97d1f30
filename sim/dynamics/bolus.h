#pragma once

#include <Eigen/Core>

namespace condyle {

/// Food between the back teeth: a spring that resists being bitten, crushed when bitten through,
/// and there again when the mouth has opened wider than it.
struct BolusSettings {
  enum class Side { none, left, right } side = Side::none;
  double size_mm = 10;
  double resistance_N = 35;      // when bitten through
  double damping_N_s_mm = 0.01;  // while closing
};

class Bolus {
 public:
  /// `point`: of the lower teeth at rest; `normal`: unit, from the upper teeth to the lower ones.
  Bolus(const BolusSettings& settings, const Eigen::Vector3d& point, const Eigen::Vector3d& normal)
      : settings_(settings), point_(point), normal_(normal) {}

  /// Force on the mandible along the normal, N, when its point is at p_C with a velocity.
  double push_N(const Eigen::Vector3d& p_C, const Eigen::Vector3d& velocity);

  const Eigen::Vector3d& point() const { return point_; }
  const Eigen::Vector3d& normal() const { return normal_; }

 private:
  BolusSettings settings_;
  Eigen::Vector3d point_, normal_;
  bool crushed_ = true;
};

}  // namespace condyle
