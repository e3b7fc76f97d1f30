#include "engine/tissue/refactorization.h"

#include <algorithm>
#include <optional>

namespace condyle {
namespace {

void make_if_none(std::optional<HessianFactor>& fresh, const HessianFactor& factor, int threads) {
  if (fresh) return;
  fresh.emplace(factor.another());
  fresh->set_threads(threads);
}

/// Continues from the minimum found with another factor: no iteration where the exact factor
/// confirms it.
MinimizeResult go_on_exactly(const SpringPrismMesh& mesh, const MeshLoads& loads,
                             SpringPrismEnergy& energy, const HessianFactor& factor,
                             const MinimizeSettings& settings, std::optional<HessianFactor>& fresh,
                             Nodes& x) {
  make_if_none(fresh, factor, energy.threads());
  MinimizeSettings here = settings;
  here.fresh = true;
  if (fresh->refactor(mesh, loads, x, energy.threads(), HessianKind::exact) > 0) {
    fresh->refactor(mesh, loads, x, energy.threads());
    here.fresh = false;
    here.tolerance_mm *= 0.01;  // buckling: leave the ridge
  }
  return minimize(energy, *fresh, here, x);
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

MinimizeResult minimize_with_refactorization(const SpringPrismMesh& mesh, const MeshLoads& loads,
                                             SpringPrismEnergy& energy, const HessianFactor& factor,
                                             const MinimizeSettings& settings, Nodes& x,
                                             const RefactorPolicy& schedule) {
  std::optional<HessianFactor> fresh;
  bool exact_serves = true;
  int refresh = 0, next = schedule.first;  // iteration
  MinimizeResult before;                   // at the last refactorisation
  const auto renew = [&](const Nodes& now, const MinimizeResult& done) -> const Preconditioner* {
    if (done.iterations < next) return nullptr;
    // At the transition of a spring to compression the exact matrix may be nearly singular and
    // steps are shortened; the Gauss-Newton factor is then used next.
    if (fresh)
      exact_serves = !exact_serves || done.evaluations - before.evaluations <=
                                          2 * (done.iterations - before.iterations) + 1;
    make_if_none(fresh, factor, energy.threads());
    const bool near = refresh >= schedule.far;
    if (!near || !exact_serves ||
        fresh->refactor(mesh, loads, now, energy.threads(), HessianKind::exact) > 0)
      fresh->refactor(mesh, loads, now, energy.threads());
    next = done.iterations +
           (near ? std::min(schedule.later + (refresh - schedule.far) / 2 * 3, schedule.most)
                 : schedule.each_far);
    ++refresh;
    before = done;
    return &*fresh;
  };
  MinimizeSettings renewing = settings;
  renewing.renew = renew;
  MinimizeResult result = minimize(energy, factor, renewing, x);
  constexpr int max_rounds = 20;
  bool confirmed = !schedule.confirm;
  for (int round = 0; result.converged() && !confirmed && round < max_rounds; ++round) {
    MinimizeSettings rest = settings;
    rest.max_iterations -= result.iterations;
    const MinimizeResult more = go_on_exactly(mesh, loads, energy, factor, rest, fresh, x);
    confirmed = more.converged() && more.iterations == 0;
    add_to(result, more);
  }
  if (result.converged() && !confirmed) result.status = MinimizeResult::Status::stalled;
  if (fresh) result.bytes += fresh->bytes();
  return result;
}

}  // namespace condyle
