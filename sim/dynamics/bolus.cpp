#include "sim/dynamics/bolus.h"

#include <algorithm>

namespace condyle {

double Bolus::push_N(const Eigen::Vector3d& p_C, const Eigen::Vector3d& velocity) {
  constexpr double bitten_through = 0.05;  // of its size
  const double gap = (p_C - point_).dot(normal_), speed = velocity.dot(normal_);
  if (gap > settings_.size_mm) crushed_ = false;
  if (gap < bitten_through * settings_.size_mm) crushed_ = true;
  if (crushed_ || gap >= settings_.size_mm) return 0;
  const double spring = settings_.resistance_N / settings_.size_mm * (settings_.size_mm - gap);
  return spring + settings_.damping_N_s_mm * std::max(-speed, 0.0);
}

}  // namespace condyle
