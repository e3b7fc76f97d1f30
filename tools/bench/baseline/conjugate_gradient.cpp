#include "tools/bench/baseline/line_search.h"
#include "tools/bench/baseline/methods.h"

namespace condyle::minimizers {

MinimizeResult conjugate_gradient(LineSearch search, Objective& objective,
                                  const BaselineSettings& settings, Points& x) {
  MinimizeResult result;
  Counted counted(objective, settings, result);
  Points g, g_new, d(x.size()), trial(x.size());
  double f = counted.value_and_gradient(x, g);
  double gg = dot(g, g);
  result.bytes = bytes_of(g, g, d, trial);
  result.energy = f;
  result.residual = largest_norm(g);
  if (!std::isfinite(f) || !std::isfinite(gg)) {
    result.status = MinimizeResult::Status::bad_start;
    return result;
  }
  for (std::size_t i = 0; i < x.size(); ++i) d[i] = -g[i];

  // The first trial step along a direction has the length of the last iteration's.
  double moved = 0.1 * settings.max_step_mm;
  bool steepest = true;  // d is minus the gradient
  result.status = MinimizeResult::Status::budget_spent;
  if (gg == 0) result.status = MinimizeResult::Status::converged;
  while (gg > 0 && result.iterations < settings.max_iterations && !counted.spent()) {
    ++result.iterations;
    const double reach = largest_norm(d);
    LineSettings line;
    line.first_step = moved / reach;
    line.greatest = settings.max_step_mm / reach;
    line.tolerance = settings.line_tolerance;
    line.max_evaluations = std::min(60, settings.max_evaluations - result.evaluations);
    const LinePoint start{0, f, dot(g, d)};
    const LinePoint found = search == LineSearch::derivative
                                ? search_by_slopes(
                                      [&](double t) {
                                        step_along(x, t, d, trial);
                                        const double value =
                                            counted.value_and_gradient(trial, g_new);
                                        return LinePoint{t, value, dot(g_new, d)};
                                      },
                                      start, line)
                                : search_by_parabolas(
                                      [&](double t) {
                                        step_along(x, t, d, trial);
                                        return counted.value(trial);
                                      },
                                      start, line);
    if (!(found.value < f)) {
      // Conjugacy may have been lost: restart with steepest descent.
      if (steepest) {
        result.status = MinimizeResult::Status::stalled;
        break;
      }
    } else {
      step_along(x, found.t, d, x);
    }
    const double before = f;
    f = counted.value_and_gradient(x, g_new);
    double change = 0;
    for (std::size_t i = 0; i < x.size(); ++i) change += g_new[i].dot(g_new[i] - g[i]);
    double beta = found.t > 0 ? std::max(0.0, change / gg) : 0.0;
    g.swap(g_new);
    gg = dot(g, g);
    if (found.t > 0) {
      const double step = found.t * reach;
      if (settled(settings, step, before, f)) {
        result.status = MinimizeResult::Status::converged;
        break;
      }
      moved = step;
    }
    steepest = beta == 0;
    for (std::size_t i = 0; i < x.size(); ++i) d[i] = beta * d[i] - g[i];
    if (dot(g, d) >= 0) {
      steepest = true;
      for (std::size_t i = 0; i < x.size(); ++i) d[i] = -g[i];
    }
  }
  result.energy = f;
  result.residual = largest_norm(g);
  result.bytes = bytes_of(g, g_new, d, trial);
  return result;
}

}  // namespace condyle::minimizers
