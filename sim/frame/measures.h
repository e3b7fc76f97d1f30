#pragma once

#include <Eigen/Core>

namespace condyle {

/// Finite helical axis of a pose against rest: the jaw turned about this line and slid along it.
struct HelicalAxis {
  bool known = false;  // a jaw that has turned by less than a degree has none to speak of
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // unit, turning by the right hand
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // on it, nearest to between the condyles, mm
  double slide_mm = 0;                              // along the direction
};

/// What a clinician reads off one frame. Points in the cranium's frame, mm.
struct Measures {
  Eigen::Vector3d incisor = Eigen::Vector3d::Zero();  // lower incisal point
  Eigen::Vector3d left_condyle = Eigen::Vector3d::Zero();
  Eigen::Vector3d right_condyle = Eigen::Vector3d::Zero();
  double opening_mm = 0;              // drop of the lower incisal point along -z from rest
  double incisal_way_mm = 0;          // of the lower incisal point from rest, straight
  double interincisal_mm = 0;         // between upper and lower incisal points
  double rotation_deg = 0;            // of the mandible from rest
  double protrusion_mm = 0;           // of the lower incisal point from rest, forward
  double laterotrusion_mm = 0;        // the same to the patient's left
  double midline_deviation_mm = 0;    // of the lower incisal point from the upper one, to the left
  double left_condyle_travel_mm = 0;  // from rest, straight
  double right_condyle_travel_mm = 0;
  HelicalAxis helical_axis;
};

}  // namespace condyle
