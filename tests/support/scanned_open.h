#pragma once

#include <Eigen/Geometry>

#include "engine/core/units.h"
#include "sim/case/case.h"

namespace condyle::test {

/// The patient as scanned with the jaw turned open about its condyles.
inline Case scanned_open(Case patient, double turn_deg) {
  const Eigen::Vector3d left = *patient.landmarks.find("left_condyle");
  const Eigen::Vector3d right = *patient.landmarks.find("right_condyle");
  const Eigen::Vector3d hinge = 0.5 * (left + right);
  const Eigen::Quaterniond R(Eigen::AngleAxisd(turn_deg * degree, (left - right).normalized()));
  const Pose open{R, hinge - R * hinge};
  for (Part& part : patient.parts)
    if (part.body == mandible_body)
      for (auto& v : part.mesh.vertices) v = open * v;
  for (const char* name : {"lower_incisal_point", "left_condyle", "right_condyle"})
    patient.landmarks.points[name] = open * patient.landmarks.points[name];
  return patient;
}

}  // namespace condyle::test
