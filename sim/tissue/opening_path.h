#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/math/pose.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

/// The tissue along a plain opening of the jaw, solved once when the model is built: what a frame's
/// minimisation starts from. Knots are evenly spaced in the angle of opening, the first at rest.
struct OpeningPath {
  Eigen::Vector3d condyles = Eigen::Vector3d::Zero();  // midpoint, mm
  double step_rad = 0.063;
  std::vector<Nodes> nodes;  // one state per knot; empty while the path is being made

  /// Plain opening by an angle: about the condyles, which slide forward and down with it.
  Pose pose(double angle_rad) const;
  /// Angle of the plain opening nearest to a pose, within the path.
  double parameter(const Pose& X_CM) const;

  /// Cubic interpolation between the knots (Catmull-Rom).
  struct Weights {
    std::array<int, 4> knot{};
    std::array<double, 4> weight{};
  };
  Weights weights(double angle_rad) const;
};

}  // namespace condyle
