#pragma once

#include <Eigen/Core>

#include "engine/rigid/rigid_world.h"
#include "sim/case/jaw_mechanics.h"

namespace condyle {

/// The hyoid: a small bone that hangs in muscles. Its mass is so small and its damping so large
/// that a step of a millisecond is taken implicitly in the velocities.
class Hyoid {
 public:
  /// Its drag acts on the velocity of `drag_at`, which moves with it.
  Hyoid(const BoneMechanics& bone, const Eigen::Vector3d& drag_at);

  const Pose& pose() const { return X_CH_; }  // rest to now
  Eigen::Vector3d velocity(const Eigen::Vector3d& p_C) const;

  /// Collects a pull at a point (cranium) along a unit direction; `slope_N_s_mm`: how much it grows
  /// for each mm/s that the point moves against it.
  void pull(const Eigen::Vector3d& p_C, const Eigen::Vector3d& direction, double force_N,
            double slope_N_s_mm);
  /// Steps with gravity and what was collected, which is then forgotten.
  void step(double step_s, const Eigen::Vector3d& gravity_mm_s2);
  /// Carries it to a pose instead.
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
