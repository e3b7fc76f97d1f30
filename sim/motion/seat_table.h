#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/math/pchip.h"
#include "sim/motion/joint_surfaces.h"

namespace condyle {

/// Condyle to fossa: as at rest, and on the slope of the eminence.
struct DiscGap {
  double seated_mm = 2.5, front_mm = 1.3;
  double at(double forward_mm) const;
};

/// Where a joint's own fossa lets its condyle go: the drop of its centre that keeps the disc gap,
/// by forward travel, opening rotation and shift to the side. A table filled once and read smoothly
/// (once differentiable), so that a pose costs no search.
class SeatTable {
 public:
  struct Settings {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the condyle at rest
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();   // of opening rotation, to the left
    DiscGap gap;
    double longest_mm = 18;      // of forward travel
    double widest_shift_mm = 0;  // 0: the joint is not asked aside
    double largest_theta = 0.8;  // rad
  };
  /// Seats are found on `threads` threads; the same bits for any number.
  SeatTable(const JointSurfaces& joint, JawSide side, const Settings& settings, int threads);

  /// Drop of the condyle (toward -z, mm). Not less than 0, never falling with forward travel; 0 at
  /// the seat and behind it.
  double drop_mm(double forward_mm, double theta, double shift_mm) const;

 private:
  std::vector<double> theta_, shift_;
  std::vector<Pchip> drop_;  // of each theta, for each shift, by forward travel
};

}  // namespace condyle
