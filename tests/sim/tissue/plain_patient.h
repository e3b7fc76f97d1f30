#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/case/case.h"

namespace condyle::test {

/// Closed box as a bone.
inline TriMesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.emplace_back(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(),
                               k & 4 ? high.z() : low.z());
  for (const auto& q : {std::array{0, 2, 3, 1},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 6, 7, 3},
                        {0, 4, 6, 2},
                        {1, 3, 7, 5}}) {
    mesh.triangles.emplace_back(q[0], q[1], q[2]);
    mesh.triangles.emplace_back(q[0], q[2], q[3]);
  }
  return mesh;
}

/// A plain patient: half a tube of skin with closed lips in front of two blocks of bone.
inline Case plain_patient() {
  Case patient;
  TriMesh face;
  constexpr int columns = 90, rows = 110;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double angle = (i - columns / 2) * 0.038;
      face.vertices.emplace_back(58 * std::sin(angle), -40 - 62 * std::cos(angle), 10 - 1.7 * j);
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, below = a + columns + 1;
      face.triangles.emplace_back(a, below, below + 1);
      face.triangles.emplace_back(a, below + 1, a + 1);
    }
  patient.parts.push_back({"skull", Role::skull, box({-40, -88, -44}, {40, 0, 20}), {}});
  patient.parts.push_back({"mandible", Role::mandible, box({-40, -88, -92}, {40, -20, -57}), {}});
  patient.parts.push_back({"face", Role::face, face, {}});
  patient.landmarks.points = {
      {"left_condyle", {50, -13, -7.5}},      {"right_condyle", {-50, -13, -7.5}},
      {"upper_incisal_point", {0, -90, -50}}, {"lower_incisal_point", {0, -90, -51}},
      {"stomion", {0, -102, -50.5}},          {"left_cheilion", {24, -96.5, -50.5}},
      {"right_cheilion", {-24, -96.5, -50.5}}};
  return patient;
}

/// Opening about the condyles, which translate forward and down.
inline Pose opening(const Case& patient, double degrees) {
  const Eigen::Vector3d condyles =
      0.5 * (*patient.landmarks.find("left_condyle") + *patient.landmarks.find("right_condyle"));
  const double slide = std::max(0.0, degrees - 4) * 0.5;
  Pose X_CM;
  X_CM.R = Eigen::Quaterniond(
      Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitX()));
  X_CM.t =
      condyles - X_CM.R * condyles + Eigen::Vector3d(0, -slide, -7.3 * (1 - std::exp(-slide / 6)));
  return X_CM;
}

}  // namespace condyle::test
