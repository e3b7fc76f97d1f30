#pragma once

#include <cmath>
#include <numbers>

#include "sim/case/case.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle::test {

/// A jaw of average size with a known joint and no obstacles.
inline Case free_jaw() {
  Case patient;
  patient.name = "free jaw";
  patient.scan_opening_mm = 0;  // without teeth that could meet
  patient.parts.push_back({"mandible", Role::mandible, box({-50, -90, -60}, {50, -10, -50}), {}});
  patient.parts.push_back({"maxilla", Role::maxilla, box({-20, -90, -40}, {20, -60, -30}), {}});
  patient.landmarks.points = {{"lower_incisal_point", {0, -92.5, -50.9}},
                              {"upper_incisal_point", {0, -95.2, -53.2}},
                              {"left_condyle", {50.5, -13, -7.5}},
                              {"right_condyle", {-50.5, -13, -7.5}}};
  patient.condylar_path = CondylarPath{{0, 2, 4, 6, 8, 10, 12, 14, 16, 18},
                                       {0, 0.55, 1.75, 3.4, 5.05, 6.3, 7.0, 7.3, 7.3, 7.1}};
  return patient;
}

/// Two spherical condyles in hollow boxes of roof and slope: a joint with 2 mm of clearance.
inline Case jaw_in_fossae() {
  Case patient = free_jaw();
  patient.condylar_path.reset();
  TriMesh condyles, roofs;
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector3d center(50.5 * side, -13, -7.5);
    condyles = joined(condyles, sphere(3, 5, center));
    // A slab 7 mm above the centre, leaning 35 degrees down toward the front.
    const Eigen::Quaterniond lean(
        Eigen::AngleAxisd(35 * std::numbers::pi / 180, Eigen::Vector3d::UnitX()));
    roofs = joined(roofs, moved(box({-15, -40, 7}, {15, 10, 12}), {lean, center}));
  }
  patient.parts[0].mesh = joined(patient.parts[0].mesh, condyles);
  patient.parts[1].mesh = joined(patient.parts[1].mesh, roofs);
  return patient;
}

/// The free jaw with molars that meet flat and upper incisors that lean back
/// at 45 degrees and overlap the lower ones by 2 mm.
inline Case jaw_with_teeth() {
  Case patient = free_jaw();
  TriMesh upper = box({-30, -75, -45}, {30, -50, -40});
  TriMesh lower = box({-30, -75, -50}, {30, -50, -45.1});
  const Eigen::Quaterniond lean(Eigen::AngleAxisd(-std::numbers::pi / 4, Eigen::Vector3d::UnitX()));
  upper = joined(upper, moved(box({-10, -3, 0}, {10, 0, 12}), {lean, {0, -95.65, -53}}));
  lower = joined(lower, box({-10, -93.5, -60}, {10, -91, -51}));
  patient.parts.push_back({"upper_teeth", Role::upper_teeth, upper, {}});
  patient.parts.push_back({"lower_teeth", Role::lower_teeth, lower, {}});
  return patient;
}

}  // namespace condyle::test
