#pragma once

#include <Eigen/Core>

#include "engine/rigid/rigid_world.h"
#include "sim/case/jaw_mechanics.h"

namespace condyle {

/// The hyoid: a small bone suspended by muscles. Its mass is so small and its damping so large that
/// a step of one millisecond is implicit in the velocities.
class Hyoid {
 public:
  /// Drag acts on the velocity of the body-fixed point `drag_at`.
  Hyoid(const BoneMechanics& bone, const Eigen::Vector3d& drag_at);

  const Pose& pose() const { return X_CH_; }  // rest to now
  Eigen::Vector3d velocity(const Eigen::Vector3d& p_C) const;

  /// Adds a force at a point (cranium) along a unit direction; `slope_N_s_mm`: increase of the
  /// force per mm/s of motion of the point against it.
  void pull(const Eigen::Vector3d& p_C, const Eigen::Vector3d& direction, double force_N,
            double slope_N_s_mm);
  /// Steps under gravity and the added forces, and clears these.
  void step(double step_s, const Eigen::Vector3d& gravity_mm_s2);
  /// Sets the pose instead.
  void carry(const Pose& X_CH, double step_s);

 private:
  Eigen::Vector3d center() const { return X_CH_ * bone_.center; }

  BoneMechanics bone_;
  Eigen::Vector3d drag_at_;
  Pose X_CH_;
  RigidMotion motion_;
  Eigen::Matrix<double, 6, 1> wrench_ = Eigen::Matrix<double, 6, 1>::Zero();   // about the centre
  Eigen::Matrix<double, 6, 6> damping_ = Eigen::Matrix<double, 6, 6>::Zero();  // kg, mm, s
};

}  // namespace condyle
