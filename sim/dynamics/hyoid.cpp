#include "sim/dynamics/hyoid.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "engine/core/units.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d out;
  out << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return out;
}

}  // namespace

Hyoid::Hyoid(const BoneMechanics& bone, const Vector3d& drag_at) : bone_(bone), drag_at_(drag_at) {}

Vector3d Hyoid::velocity(const Vector3d& p_C) const {
  return motion_.velocity + motion_.spin.cross(p_C - center());
}

void Hyoid::pull(const Vector3d& p_C, const Vector3d& direction, double force_N,
                 double slope_N_s_mm) {
  Vector6d row;
  row << direction, (p_C - center()).cross(direction);
  wrench_ += mm_per_m * force_N * row;
  damping_ += mm_per_m * slope_N_s_mm * row * row.transpose();
}

void Hyoid::step(double step_s, const Vector3d& gravity_mm_s2) {
  const Matrix3d R = X_CH_.R.toRotationMatrix();
  const Vector3d arm = X_CH_ * drag_at_ - center();
  Eigen::Matrix<double, 3, 6> dragged;  // velocity where the drag acts
  dragged << Matrix3d::Identity(), -cross_matrix(arm);
  Eigen::Matrix<double, 6, 6> drag = bone_.drag_kg_s * dragged.transpose() * dragged;
  drag.bottomRightCorner<3, 3>() += bone_.turning_drag_kg_mm2_s * Matrix3d::Identity();
  Eigen::Matrix<double, 6, 6> A = step_s * (damping_ + drag);
  A.topLeftCorner<3, 3>() += bone_.mass_kg * Matrix3d::Identity();
  A.bottomRightCorner<3, 3>() += R * bone_.inertia * R.transpose();
  Vector6d v;
  v << motion_.velocity, motion_.spin;
  wrench_.head<3>() += bone_.mass_kg * gravity_mm_s2;
  v += A.ldlt().solve(Vector6d(step_s * (wrench_ - drag * v)));
  motion_ = {v.head<3>(), v.tail<3>()};
  const Vector3d c = center() + step_s * motion_.velocity;
  const double angle = step_s * motion_.spin.norm();
  if (angle > 0)
    X_CH_.R = (Eigen::AngleAxisd(angle, motion_.spin.normalized()) * X_CH_.R).normalized();
  X_CH_.t = c - X_CH_.R * bone_.center;
  wrench_.setZero();
  damping_.setZero();
}

void Hyoid::carry(const Pose& X_CH, double step_s) {
  const Vector3d before = center();
  X_CH_ = X_CH;
  motion_ = {(center() - before) / step_s, Vector3d::Zero()};
  wrench_.setZero();
  damping_.setZero();
}

}  // namespace condyle
