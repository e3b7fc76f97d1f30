#pragma once

#include <cstddef>
#include <functional>

#include "engine/minimize/objective.h"

namespace condyle {

struct MinimizeResult;

struct MinimizeSettings {
  /// The iteration stops where the estimated distance to the minimum, of the worst point, is
  /// below this. The estimate comes from the preconditioned gradient and its rate of contraction.
  double tolerance_mm = 1e-3;
  int max_iterations = 2000;
  int max_evaluations = 1000000000;
  double max_step_mm = 4.0;  // displacement of any point in one iteration
  /// The preconditioner was made at the start and is accurate there. The first step is tried at
  /// full length without evaluating the curvature along it. The final curvature check is skipped
  /// where the estimated distance is below a fifth of the tolerance; where the check shows that the
  /// objective is stiffer than the preconditioner, the estimate is reduced accordingly, by half at
  /// most.
  bool fresh = false;
  /// Whether the last iteration that is allowed ends with a check of convergence, which takes one
  /// more solve with the preconditioner. Without it the status is then `budget_spent`.
  bool check_last = true;
  /// Called after each iteration with the point reached and the result so far, while it is still
  /// open whether more iterations follow. Returns another preconditioner for them, or null.
  std::function<const Preconditioner*(const Points& x, const MinimizeResult& done)> renew = {};
};

struct MinimizeResult {
  enum class Status {
    converged,
    budget_spent,  // iterations or evaluations: x is the best so far
    stalled,       // no step leads lower, and the tolerance is not met
    bad_start      // value or gradient is not finite at the start: x is as it was
  };
  Status status = Status::budget_spent;
  int iterations = 0;
  int evaluations = 0;    // of the value, with or without gradient
  int gradients = 0;      // of those, with gradient
  double energy = 0;      // the value at x
  double residual = 0;    // largest gradient of a point at x; N for an energy in mJ
  std::size_t bytes = 0;  // memory used beside x and the objective's own

  bool converged() const { return status == Status::converged; }
};

/// Moves `x` downhill to a minimum by preconditioned conjugate gradients, one Newton step along
/// each direction. Never leaves x at a higher value than at the start, nor where the objective is
/// infinite. Deterministic.
MinimizeResult minimize(Objective& objective, const Preconditioner& preconditioner,
                        const MinimizeSettings& settings, Points& x);

}  // namespace condyle
