#pragma once

#include "engine/tissue/hessian_factor.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

struct MinimizeSettings {
  double tolerance_mm = 1e-3;  // estimated distance left to the minimum, of the worst node
  int max_iterations = 2000;
  double max_step_mm = 4.0;  // of any node in one iteration
  int threads = 1;           // the result has the same bits for any number
};

struct MinimizeResult {
  int iterations = 0;
  int evaluations = 0;  // of energy with gradient
  bool converged = false;
  double energy = 0;    // mJ
  double residual = 0;  // largest nodal gradient, N
};

/// Moves `x` to the minimum of the net's energy: preconditioned Polak-Ribiere conjugate gradient
/// with a parabolic line search. Along a direction each squared length is quadratic and each volume
/// cubic, so the curvature is known exactly and one step is nearly always taken as it is.
/// `x` must have no inverted prism; no step makes one. The factor may be of any state of the net.
MinimizeResult minimize(const SpringPrismNet& net, const NetLoads& loads,
                        const HessianFactor& factor, const MinimizeSettings& settings, Nodes& x);

}  // namespace condyle
