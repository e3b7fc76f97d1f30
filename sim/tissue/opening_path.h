#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "engine/tissue/spring_prism.h"
#include "sim/frame/body_tree.h"
#include "sim/tissue/body_weights.h"

namespace condyle {

/// The tissue along a plain opening of the jaw, solved once when the model is built. Knots are
/// evenly spaced in the opening angle, the first at rest.
struct OpeningPath {
  Eigen::Vector3d condyles = Eigen::Vector3d::Zero();  // midpoint, mm
  double step_rad = 0.063;
  std::vector<Nodes> nodes;  // one state per knot; empty until the path has been solved

  /// Plain opening by an angle: about the condyles, which translate forward and down.
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

/// First-order prediction of the nodes after a step: the start of a frame's minimization.
struct OpeningPredictor {
  std::shared_ptr<const OpeningPath> path;  // may be null
  BodyId body;                              // the lower arch: its pose determines the opening
  std::vector<BodyId> along;  // bodies that the path moves: the bone that opened, or its pieces

  /// Predicts the nodes with the bodies at X_CB_to from `from`, solved with the bodies at
  /// X_CB_from: along the path as far as the motion is plain opening or closing; beyond that each
  /// node follows its bodies.
  Nodes extrapolated(const Nodes& from, const BodyWeights& weights, std::span<const Pose> X_CB_from,
                     std::span<const Pose> X_CB_to) const;
};

}  // namespace condyle
