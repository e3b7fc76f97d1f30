#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "render/life/upper_lid.h"

namespace condyle {

/// The lower lid of one eye, in pictures alone: it slides up on the eyeball with the skin of the
/// cheek below it, as in a smile; skin that moves down leaves it where it is. The tissue itself is
/// attached to the bone at the edge of the orbit.
class LowerLid {
 public:
  /// above: the upper lid of that eye. rest: vertices of the face, mm.
  LowerLid(const UpperLid& above, std::span<const Eigen::Vector3f> rest);

  /// Angle by which the present cheek raises the lid, rad; 0 where it is not higher than at rest.
  float raised(std::span<const Eigen::Vector3f> places) const;
  /// Raises the lid; no vertex enters the eyeball. gaze: unit.
  void move(float raised, const Eigen::Vector3f& gaze, std::span<Eigen::Vector3f> places) const;

 private:
  struct Member {
    int vertex;
    float share;  // of the rotation: 1 in the middle of the edge
  };
  struct Gauge {
    int vertex;
    float rest;  // height along the lid's upward axis, mm
  };
  UpperLid above_;
  std::vector<Member> members_;
  std::vector<Gauge> cheek_, edge_;
};

}  // namespace condyle
