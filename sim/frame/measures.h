#pragma once

#include <Eigen/Core>

namespace condyle {

/// What a clinician reads off one frame. Points in the cranium's frame, mm.
struct Measures {
  Eigen::Vector3d incisor = Eigen::Vector3d::Zero();  // lower incisal point
  Eigen::Vector3d left_condyle = Eigen::Vector3d::Zero();
  Eigen::Vector3d right_condyle = Eigen::Vector3d::Zero();
  double opening_mm = 0;       // drop of the lower incisal point along -z from rest
  double interincisal_mm = 0;  // between upper and lower incisal points
  double rotation_deg = 0;     // of the mandible from rest
};

}  // namespace condyle
