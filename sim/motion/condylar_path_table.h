#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/math/pchip.h"
#include "sim/motion/joint_surfaces.h"

namespace condyle {

/// Usual joint space in front of the condyle, where the disc is thinnest; source: Ikeda and
/// Kawamura 2013.
constexpr double usual_front_gap_mm = 1.3;

/// Thickness of the disc between condyle and fossa: seated, and on the slope of the eminence.
struct DiscGap {
  double seated_mm = 2.5, front_mm = usual_front_gap_mm;
  double at(double forward_mm) const;
};

/// Condylar path guided by the patient's fossa: the inferior translation of the condyle centre at
/// which the disc gap is kept, by forward travel, opening rotation and lateral shift. Tabulated
/// once and interpolated with continuous first derivative, so that a pose needs no search.
class CondylarPathTable {
 public:
  struct Settings {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the condyle at rest
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();   // of opening rotation, to the left
    DiscGap gap;
    double longest_mm = 18;      // of forward travel
    double widest_shift_mm = 0;  // 0: no lateral shift
    double largest_theta = 0.8;  // rad
  };
  /// Computed on `threads` threads; bit-identical for any number. Kept in the user's cache folder.
  CondylarPathTable(const JointSurfaces& joint, JawSide side, const Settings& settings,
                    int threads);

  /// Inferior translation of the condyle (toward -z, mm). Non-negative and non-decreasing with
  /// forward travel; 0 at the rest position and behind it.
  double inferior_translation_mm(double forward_mm, double theta, double shift_mm) const;

 private:
  std::vector<double> theta_, shift_;
  std::vector<Pchip> inferior_;  // by forward travel; for each theta and shift
};

}  // namespace condyle
