#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/math/pose.h"

namespace condyle {

/// A joint between two bodies. Points and directions in the coordinates of their body.
struct RigidJoint {
  enum class Kind {
    ball,   // p_B stays on p_A
    hinge,  // as ball, and axis_B stays on axis_A
    fixed,  // the bodies keep the pose X_AB
    guide,  // p_B stays on a curve of A, within its ends
    plane   // p_B stays on the side of the plane through p_A to which axis_A points
  } kind = Kind::ball;
  int a = 0, b = 0;  // bodies
  Eigen::Vector3d p_A = Eigen::Vector3d::Zero(), p_B = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_A = Eigen::Vector3d::UnitX(), axis_B = Eigen::Vector3d::UnitX();
  Pose X_AB = {};                             // of a fixed joint
  std::vector<Eigen::Vector3d> curve_A = {};  // of a guide: at least two points, smoothed between
  // A direction in which the point may leave the curve: it then stays on a ruled surface.
  std::optional<Eigen::Vector3d> sideways_A = {};
  double max_force_N = 1e4;  // largest constraint force (torque: times 1 mm)
};

}  // namespace condyle
