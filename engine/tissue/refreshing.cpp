#include "engine/tissue/refreshing.h"

#include <algorithm>
#include <optional>

namespace condyle {
namespace {

void make_if_none(std::optional<HessianFactor>& fresh, const HessianFactor& factor, int threads) {
  if (fresh) return;
  fresh.emplace(factor.another());
  fresh->set_threads(threads);
}

/// From where another factor says that the way is over: no iteration where an exact one agrees.
MinimizeResult go_on_exactly(const SpringPrismNet& net, const NetLoads& loads,
                             SpringPrismEnergy& energy, const HessianFactor& factor,
                             const MinimizeSettings& settings, std::optional<HessianFactor>& fresh,
                             Nodes& x) {
  make_if_none(fresh, factor, energy.threads());
  MinimizeSettings here = settings;
  here.fresh = true;
  if (fresh->refactor(net, loads, x, energy.threads(), Curvatures::exact) > 0) {
    fresh->refactor(net, loads, x, energy.threads());
    here.fresh = false;
    here.tolerance_mm *= 0.01;  // it buckles: off the ridge
  }
  return minimize(Method::preconditioned, energy, here, x, &*fresh);
}

void add_to(MinimizeResult& result, const MinimizeResult& more) {
  result.status = more.status;
  result.iterations += more.iterations;
  result.evaluations += more.evaluations;
  result.gradients += more.gradients;
  result.energy = more.energy;
  result.residual = more.residual;
  result.bytes = std::max(result.bytes, more.bytes);
}

}  // namespace

MinimizeResult minimize_refreshing(const SpringPrismNet& net, const NetLoads& loads,
                                   SpringPrismEnergy& energy, const HessianFactor& factor,
                                   const MinimizeSettings& settings, Nodes& x,
                                   const RefreshSchedule& schedule) {
  std::optional<HessianFactor> fresh;
  bool exact_serves = true;
  int refresh = 0, next = schedule.first;  // iteration
  MinimizeResult before;                   // at the last refresh
  const auto renew = [&](const Nodes& now, const MinimizeResult& done) -> const Preconditioner* {
    if (done.iterations < next) return nullptr;
    // Where a spring is about to push, the exact matrix may be nearly singular, and its steps are
    // cut short: then the other one is next.
    if (fresh)
      exact_serves = !exact_serves || done.evaluations - before.evaluations <=
                                          2 * (done.iterations - before.iterations) + 1;
    make_if_none(fresh, factor, energy.threads());
    const bool near = refresh >= schedule.far;
    if (!near || !exact_serves ||
        fresh->refactor(net, loads, now, energy.threads(), Curvatures::exact) > 0)
      fresh->refactor(net, loads, now, energy.threads());
    next = done.iterations +
           (near ? std::min(schedule.later + (refresh - schedule.far) / 2 * 3, schedule.most)
                 : schedule.each_far);
    ++refresh;
    before = done;
    return &*fresh;
  };
  MinimizeSettings renewing = settings;
  renewing.renew = renew;
  MinimizeResult result = minimize(Method::preconditioned, energy, renewing, x, &factor);
  constexpr int most_rounds = 20;
  bool confirmed = !schedule.confirm;
  for (int round = 0; result.converged() && !confirmed && round < most_rounds; ++round) {
    MinimizeSettings rest = settings;
    rest.max_iterations -= result.iterations;
    const MinimizeResult more = go_on_exactly(net, loads, energy, factor, rest, fresh, x);
    confirmed = more.converged() && more.iterations == 0;
    add_to(result, more);
  }
  if (result.converged() && !confirmed) result.status = MinimizeResult::Status::stalled;
  if (fresh) result.bytes += fresh->bytes();
  return result;
}

}  // namespace condyle
