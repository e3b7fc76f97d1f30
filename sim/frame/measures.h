#pragma once

#include <Eigen/Core>

namespace condyle {

/// Finite helical axis of a pose relative to rest: the jaw rotated about this line and translated
/// along it.
struct HelicalAxis {
  bool known = false;                                   // undefined for rotations below one degree
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // unit, right-handed rotation
  // on the axis, nearest to the midpoint of the condyles, mm
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double slide_mm = 0;  // along the direction
};

/// Clinical measures of one frame. Points in the cranium's frame, mm.
struct Measures {
  Eigen::Vector3d incisor = Eigen::Vector3d::Zero();  // lower incisal point
  Eigen::Vector3d left_condyle = Eigen::Vector3d::Zero();
  Eigen::Vector3d right_condyle = Eigen::Vector3d::Zero();
  double opening_mm = 0;               // descent of the lower incisal point along -z from rest
  double incisal_displacement_mm = 0;  // of the lower incisal point from rest, straight line
  double interincisal_mm = 0;          // between upper and lower incisal points
  double rotation_deg = 0;             // of the mandible from rest
  double protrusion_mm = 0;            // of the lower incisal point from rest, forward
  double laterotrusion_mm = 0;         // the same to the patient's left
  double midline_deviation_mm = 0;     // of the lower incisal point from the upper one, to the left
  double left_condyle_travel_mm = 0;   // from rest, straight line
  double right_condyle_travel_mm = 0;
  HelicalAxis helical_axis;
};

}  // namespace condyle
