#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/math/pose.h"

namespace condyle {

/// Where the soft tissue is, and how its minimiser ended. The next frame starts from it.
struct TissueState {
  std::vector<Eigen::Vector3d> nodes;  // mm, in the model's node order; empty without tissue
  Pose X_CM;                           // mandible pose that this state answers
  int iterations = 0;
  int evaluations = 0;  // of energy or gradient
  bool converged = true;
  double energy = 0;    // relative to rest
  double residual = 0;  // largest nodal gradient
  int inverted_prisms = 0;
};

}  // namespace condyle
