#include "engine/tissue/refreshing.h"

#include <algorithm>

namespace condyle {

MinimizeResult minimize_refreshing(const SpringPrismNet& net, const NetLoads& loads,
                                   SpringPrismEnergy& energy, const HessianFactor& factor,
                                   const MinimizeSettings& settings, Nodes& x,
                                   const RefreshSchedule& schedule) {
  MinimizeSettings part = settings;
  part.max_iterations = std::min(schedule.first, settings.max_iterations);
  MinimizeResult result = minimize(Method::preconditioned, energy, part, x, &factor);
  const auto goes_on = [&] {
    return result.status == MinimizeResult::Status::budget_spent &&
           result.iterations < settings.max_iterations &&
           result.evaluations < settings.max_evaluations;
  };
  if (!goes_on()) return result;
  HessianFactor fresh = factor.another();
  fresh.set_threads(energy.threads());
  bool exact_serves = true;
  for (int refresh = 0; goes_on(); ++refresh) {
    const bool near = refresh >= schedule.far;
    if (!near || !exact_serves ||
        fresh.refactor(net, loads, x, energy.threads(), Curvatures::exact) > 0)
      fresh.refactor(net, loads, x, energy.threads());
    const int wanted =
        near ? std::min(schedule.later + (refresh - schedule.far) / 2 * 3, schedule.most)
             : schedule.each_far;
    part.max_iterations = std::min(wanted, settings.max_iterations - result.iterations);
    part.max_evaluations = settings.max_evaluations - result.evaluations;
    const MinimizeResult before = result;
    result = minimize(Method::preconditioned, energy, part, x, &fresh);
    // Where a spring is about to push, the exact matrix may be nearly singular, and its steps are
    // cut short: then the other one is next.
    exact_serves = !exact_serves || result.evaluations <= 2 * result.iterations + 2;
    result.iterations += before.iterations;
    result.evaluations += before.evaluations;
    result.gradients += before.gradients;
  }
  result.bytes += fresh.bytes();
  return result;
}

}  // namespace condyle
