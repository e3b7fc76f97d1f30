#include "engine/tissue/refreshing.h"

#include <algorithm>
#include <optional>

namespace condyle {

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
    if (fresh) {
      // Where a spring is about to push, the exact matrix may be nearly singular, and its steps are
      // cut short: then the other one is next.
      exact_serves = !exact_serves || done.evaluations - before.evaluations <=
                                          2 * (done.iterations - before.iterations) + 1;
    } else {
      fresh.emplace(factor.another());
      fresh->set_threads(energy.threads());
    }
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
  if (fresh) result.bytes += fresh->bytes();
  return result;
}

}  // namespace condyle
