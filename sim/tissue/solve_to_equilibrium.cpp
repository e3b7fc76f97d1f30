#include <algorithm>
#include <utility>
#include <vector>

#include "sim/tissue/model.h"

namespace condyle {

double largest_displacement(const Nodes& from, const Nodes& to) {
  double most = 0;
  for (std::size_t i = 0; i < from.size(); ++i) most = std::max(most, (to[i] - from[i]).norm());
  return most;
}

TissueState solve_to_equilibrium(const TissueModel& model, const TissueState& state,
                                 double tolerance_mm, int threads, TissueWarmStart warm) {
  return solve_to_equilibrium(model, state, warm,
                              {.tolerance_mm = tolerance_mm, .threads = threads});
}

TissueState solve_to_equilibrium(const TissueModel& model, const TissueState& state,
                                 TissueWarmStart& warm, const SettleSettings& settings) {
  const auto [tolerance_mm, max_rounds, threads] = settings;
  // Settings of a round. Where tissue slides along a curved surface, soft contact and its normal
  // can oscillate.
  constexpr double firmness = 10, finer = 0.01;
  constexpr double first_contraction = 0.5, max_contraction = 0.98;
  // Rounds whose largest displacement does not fall below that of as many rounds before: tissue
  // oscillates at a sharp edge, and further rounds change nothing.
  constexpr std::size_t oscillation_rounds = 8;
  constexpr double no_decrease = 0.95;
  std::vector<double> displacements;
  const auto oscillates = [&] {
    if (displacements.size() < 2 * oscillation_rounds) return false;
    const auto middle = displacements.end() - oscillation_rounds;
    return *std::max_element(middle, displacements.end()) >
           no_decrease * *std::max_element(middle - oscillation_rounds, middle);
  };
  TissueState reached = state;
  reached.converged = false;
  double before = 0, contraction = first_contraction;
  for (int round = 0; round < max_rounds; ++round) {
    TissueState next = solve_tissue(model, reached, reached.X_CB,
                                    {.tolerance_mm = finer * tolerance_mm,
                                     .contact_firmness = firmness,
                                     .relaxed_contact = true,
                                     .threads = threads},
                                    warm, reached.excitation);
    if (next.reused) break;
    const double moved = largest_displacement(reached.nodes, next.nodes);
    // If each round shortens the displacement by a factor, the remaining sum is a geometric series.
    // A single round may be shorter by chance.
    const double last = contraction;
    if (round > 0) contraction = std::min(moved / before, max_contraction);
    next.iterations += reached.iterations;
    next.evaluations += reached.evaluations;
    reached = std::move(next);
    before = moved;
    reached.converged =
        reached.converged && moved <= tolerance_mm * (1 - std::max(contraction, last));
    displacements.push_back(moved);
    if (reached.converged || oscillates()) break;
  }
  return reached;
}

}  // namespace condyle
