#pragma once

#include "engine/minimize/minimizer_parts.h"
#include "tools/bench/baseline/baseline_minimizers.h"

/// One function per baseline minimiser; called by minimize_with().
namespace condyle::minimizers {

enum class LineSearch { parabolic, derivative };
MinimizeResult conjugate_gradient(LineSearch search, Objective& objective,
                                  const BaselineSettings& settings, Points& x);
MinimizeResult powell(Objective& objective, const BaselineSettings& settings, Points& x);
MinimizeResult quasi_newton(Objective& objective, const BaselineSettings& settings, Points& x);

/// The common stop test.
inline bool settled(const BaselineSettings& settings, double moved_mm, double before,
                    double after) {
  return moved_mm < settings.tolerance_mm ||
         before - after < settings.value_tolerance * std::abs(after);
}

}  // namespace condyle::minimizers
