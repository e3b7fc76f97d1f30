#include <algorithm>
#include <utility>

#include "sim/tissue/model.h"

namespace condyle {

double largest_way(const Nodes& from, const Nodes& to) {
  double most = 0;
  for (std::size_t i = 0; i < from.size(); ++i) most = std::max(most, (to[i] - from[i]).norm());
  return most;
}

TissueState settle(const TissueModel& model, const TissueState& state, double tolerance_mm,
                   int threads) {
  constexpr int most_rounds = 100;
  // Of a round. Where tissue slides along what is bent, soft contact and its direction would lead
  // each other round in circles.
  constexpr double firmness = 10, finer = 0.01;
  constexpr double first_contraction = 0.5, least_contraction = 0.98;
  TissueState settled = state;
  settled.converged = false;
  double before = 0, contraction = first_contraction;
  for (int round = 0; round < most_rounds; ++round) {
    TissueState next = follow(
        model, settled, settled.X_CM,
        {.tolerance_mm = finer * tolerance_mm, .contact_firmness = firmness, .threads = threads});
    if (next.kept) break;
    const double way = largest_way(settled.nodes, next.nodes);
    // Rounds that shorten the way by a factor each leave the sum of a geometric series. One alone
    // may be shorter by chance.
    const double last = contraction;
    if (round > 0) contraction = std::min(way / before, least_contraction);
    next.iterations += settled.iterations;
    next.evaluations += settled.evaluations;
    settled = std::move(next);
    before = way;
    settled.converged =
        settled.converged && way <= tolerance_mm * (1 - std::max(contraction, last));
    if (settled.converged) break;
  }
  return settled;
}

}  // namespace condyle
