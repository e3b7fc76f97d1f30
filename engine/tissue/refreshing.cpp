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
  HessianFactor fresh = factor;
  while (result.status == MinimizeResult::Status::budget_spent &&
         result.iterations < settings.max_iterations &&
         result.evaluations < settings.max_evaluations) {
    fresh.refactor(net, loads, x);
    part.max_iterations = std::min(schedule.later, settings.max_iterations - result.iterations);
    part.max_evaluations = settings.max_evaluations - result.evaluations;
    const MinimizeResult before = result;
    result = minimize(Method::preconditioned, energy, part, x, &fresh);
    result.iterations += before.iterations;
    result.evaluations += before.evaluations;
    result.gradients += before.gradients;
  }
  result.bytes += fresh.bytes();
  return result;
}

}  // namespace condyle
