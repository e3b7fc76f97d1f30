#include "sim/motion/measure_pose.h"

#include <cmath>

#include "engine/core/units.h"

namespace condyle {
namespace {

/// The axis of X, through its point nearest to `near`.
HelicalAxis helical_axis(const Pose& X, const Eigen::Vector3d& near) {
  constexpr double min_deg = 1;
  HelicalAxis axis;
  const double angle = rotation_angle(X);
  if (angle * degrees_per_radian < min_deg) return axis;
  axis.known = true;
  axis.direction = X.R.vec().normalized() * (X.R.w() < 0 ? -1 : 1);
  axis.slide_mm = axis.direction.dot(X.t);
  const Eigen::Vector3d across = X.t - axis.slide_mm * axis.direction;
  const Eigen::Vector3d foot =
      0.5 * (across + axis.direction.cross(across) / std::tan(0.5 * angle));
  axis.point = foot + axis.direction.dot(near - foot) * axis.direction;
  return axis;
}

}  // namespace

Measures measure(const Case& patient, const BodyPoses& given) {
  const BodyPoses at = completed(patient.bodies, given);
  const JawBodies& jaw = patient.jaw;
  const Pose& X_CM = at[jaw.lower_arch];
  const Pose from_closed = composed(X_CM, patient.X_CM_closed.inverse());
  const Landmarks& landmarks = patient.landmarks;
  Measures out;
  if (const auto p = landmarks.find("lower_incisal_point")) {
    const Eigen::Vector3d closed = patient.X_CM_closed * *p;
    out.incisor = X_CM * *p;
    out.opening_mm = closed.z() - out.incisor.z();
    out.incisal_displacement_mm = (out.incisor - closed).norm();
    out.protrusion_mm = closed.y() - out.incisor.y();
    out.laterotrusion_mm = out.incisor.x() - closed.x();
    if (const auto at_rest = landmarks.find("upper_incisal_point")) {
      const Eigen::Vector3d upper = at[jaw.upper_arch] * *at_rest;
      out.interincisal_mm = (out.incisor - upper).norm();
      out.midline_deviation_mm = out.incisor.x() - upper.x();
    }
  }
  const auto left = landmarks.find("left_condyle"), right = landmarks.find("right_condyle");
  if (left) {
    out.left_condyle = at[jaw.left_condyle] * *left;
    out.left_condyle_travel_mm = (out.left_condyle - *left).norm();
  }
  if (right) {
    out.right_condyle = at[jaw.right_condyle] * *right;
    out.right_condyle_travel_mm = (out.right_condyle - *right).norm();
  }
  out.rotation_deg = rotation_angle(from_closed) * degrees_per_radian;
  out.helical_axis =
      helical_axis(from_closed, left && right ? Eigen::Vector3d(0.5 * (*left + *right))
                                              : Eigen::Vector3d(X_CM.t));
  return out;
}

}  // namespace condyle
