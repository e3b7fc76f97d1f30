#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "engine/minimize/objective.h"

namespace condyle {

/// cg_parabolic, cg_derivative: Polak-Ribiere conjugate gradient; its line search fits parabolas to
/// values, or follows derivatives. powell: direction set, values only. quasi_newton: BFGS with the
/// full inverse. preconditioned: conjugate gradient with a Preconditioner, one Newton step along
/// each direction; the one for the frame loop, started from the last frame.
/// source: Press et al., Numerical Recipes, for the first four.
enum class Method { cg_parabolic, cg_derivative, powell, quasi_newton, preconditioned };

/// What is known of a method without running it.
struct MethodFacts {
  Method method;
  const char* name;          // as in the benchmarks
  const char* title;         // for people
  const char* memory_order;  // of the additional memory, N parameters
  bool derivatives;
};
std::span<const MethodFacts> all_methods();

struct MinimizeResult;

struct MinimizeSettings {
  /// preconditioned: estimated distance left to the minimum, of the worst point, from the
  /// preconditioned gradient and how fast iterations shorten it. The others: the largest way of any
  /// point in one iteration.
  double tolerance_mm = 1e-3;
  /// The others also stop where an iteration lowers the value by less than this share of it; 0:
  /// never.
  double value_tolerance = 0;
  int max_iterations = 2000;
  int max_evaluations = 1000000000;
  double max_step_mm = 4.0;  // of any point in one iteration; not for powell
  /// preconditioned: the preconditioner was made of the start, and fits there. The first step is
  /// tried at full length, without a look at the curvature along it. At the end no look is taken
  /// where the way left is below a fifth of what would do; and where one shows that the objective is
  /// stiffer than the preconditioner, the way left counts as so much shorter, down to half.
  bool fresh = false;
  /// preconditioned: asked with what has been done after each iteration that more may follow,
  /// before it is known whether they must; another preconditioner for them, or null.
  std::function<const Preconditioner*(const Points& x, const MinimizeResult& done)> renew = {};
  double line_tolerance = 0.1;  // of the line searches of the first three: width over position
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

/// Moves `x` downhill to a minimum. Never leaves x at a higher value than it was given, nor where
/// the objective is infinite. Repeats to the bit. `preconditioned` wants a preconditioner.
MinimizeResult minimize(Method method, Objective& objective, const MinimizeSettings& settings,
                        Points& x, const Preconditioner* preconditioner = nullptr);

}  // namespace condyle
