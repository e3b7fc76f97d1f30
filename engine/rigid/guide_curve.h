#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace condyle {

/// A smooth curve through points: cubics with continuous slope (parabolas through neighbours).
class GuideCurve {
 public:
  /// throws: InputError with fewer than two points, or where two in a row coincide.
  explicit GuideCurve(std::vector<Eigen::Vector3d> points);

  struct Place {
    Eigen::Vector3d point;
    Eigen::Vector3d along;     // unit, towards the end
    double from_start_mm = 0;  // straight on along the end's slope, beyond an end: negative
    double from_end_mm = 0;
  };
  /// The place next to p; ways along `sideways` (unit) count for nothing.
  Place nearest(const Eigen::Vector3d& p, const std::optional<Eigen::Vector3d>& sideways) const;

 private:
  void at(double s, Eigen::Vector3d& point, Eigen::Vector3d& slope) const;

  std::vector<Eigen::Vector3d> points_, slopes_;  // slopes by length
  std::vector<double> length_;                    // of each span, chord
  std::vector<Eigen::Vector3d> marks_;            // evenly in each span: where a search starts
};

}  // namespace condyle
