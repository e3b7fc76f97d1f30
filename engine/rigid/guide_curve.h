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
    double from_start_mm = 0;  // arc length; negative beyond an end, along its tangent
    double from_end_mm = 0;
  };
  /// The point of the curve nearest to p; distances along `sideways` (unit) are ignored.
  Place nearest(const Eigen::Vector3d& p, const std::optional<Eigen::Vector3d>& sideways) const;

 private:
  void at(double s, Eigen::Vector3d& point, Eigen::Vector3d& slope) const;

  std::vector<Eigen::Vector3d> points_, slopes_;  // derivatives by length
  std::vector<double> length_;                    // of each span, chord
  std::vector<Eigen::Vector3d> marks_;  // uniform in each span: starting points of searches
};

}  // namespace condyle
