#pragma once

#include <Eigen/Geometry>

#include "engine/math/pose.h"
#include "sim/case/case.h"

namespace condyle::test {

/// Targets of the mandible, and of the bodies after it in their parents' frames.
inline std::vector<Pose> target_poses(const Pose& X_CM, const std::vector<Pose>& others = {}) {
  std::vector<Pose> X_PB{Pose{}, X_CM};
  X_PB.insert(X_PB.end(), others.begin(), others.end());
  return X_PB;
}

/// Closed axis-aligned box, 12 triangles, outward.
inline TriMesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1) ? high.x() : low.x(), (i & 2) ? high.y() : low.y(),
                               (i & 4) ? high.z() : low.z());
  for (const auto& t : {Eigen::Vector3i{0, 2, 1},
                        {1, 2, 3},
                        {4, 5, 6},
                        {5, 7, 6},
                        {0, 1, 4},
                        {1, 5, 4},
                        {2, 6, 3},
                        {3, 6, 7},
                        {0, 4, 2},
                        {2, 4, 6},
                        {1, 3, 5},
                        {3, 7, 5}})
    mesh.triangles.push_back(t);
  return mesh;
}

/// A patient of nothing but these.
inline Case two_bones(TriMesh maxilla, TriMesh mandible) {
  Case patient;
  patient.name = "two bones";
  patient.parts.push_back({"maxilla", Role::maxilla, std::move(maxilla), {}});
  patient.parts.push_back({"mandible", Role::mandible, std::move(mandible), {}});
  return patient;
}

inline Pose shift(double x, double y, double z) {
  return {Eigen::Quaterniond::Identity(), {x, y, z}};
}

/// A maxilla and a mandible made of boxes, 1 mm apart, with the landmarks that motion needs.
inline Case box_patient() {
  Case patient;
  patient.name = "boxes";
  patient.parts.push_back({"maxilla", Role::maxilla, box({-30, -90, -40}, {30, -40, 0}), {}});
  patient.parts.push_back({"mandible", Role::mandible, box({-50, -92, -80}, {50, 0, -41}), {}});
  patient.landmarks.points = {{"upper_incisal_point", {0, -90, -40}},
                              {"lower_incisal_point", {0, -92, -41}},
                              {"left_condyle", {48, -5, -12}},
                              {"right_condyle", {-48, -5, -12}}};
  return patient;
}

}  // namespace condyle::test
