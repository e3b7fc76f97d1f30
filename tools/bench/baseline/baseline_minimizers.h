#pragma once

#include <span>

#include "engine/minimize/minimize.h"

namespace condyle {

/// Minimisers that are compared in the benchmarks. cg_parabolic, cg_derivative: Polak-Ribiere
/// conjugate gradient; its line search fits parabolas to values, or follows derivatives. powell:
/// direction set, values only. quasi_newton: BFGS with the full inverse. preconditioned: the
/// production method, engine/minimize.
/// source: Press et al., Numerical Recipes, for the first four.
enum class Method { cg_parabolic, cg_derivative, powell, quasi_newton, preconditioned };

/// Static description of a method.
struct MethodFacts {
  Method method;
  const char* name;          // as in the benchmarks
  const char* title;         // for people
  const char* memory_order;  // of the additional memory, N parameters
  bool derivatives;
};
std::span<const MethodFacts> all_methods();

/// The first four methods use these common settings: tolerance_mm (displacement of any point in one
/// iteration), both budgets and max_step_mm (not powell).
struct BaselineSettings : MinimizeSettings {
  BaselineSettings(const MinimizeSettings& common = {}) : MinimizeSettings(common) {}
  /// They also stop where an iteration lowers the value by less than this fraction; 0: never.
  double value_tolerance = 0;
  double line_tolerance = 0.1;  // of the line searches: interval width over position
};

/// Moves `x` downhill to a minimum, as minimize() does. `preconditioner`: for
/// Method::preconditioned only. throws: std::logic_error without it.
MinimizeResult minimize_with(Method method, Objective& objective, const BaselineSettings& settings,
                             Points& x, const Preconditioner* preconditioner = nullptr);

}  // namespace condyle
