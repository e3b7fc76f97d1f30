#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/minimize/minimize.h"
#include "sim/tissue/model.h"

namespace condyle {

using Eigen::Vector3d;

NetLoads loads_at(const TissueModel& model, const Pose& X_CM) {
  NetLoads loads;
  const auto& net = model.net;
  loads.anchor_target.resize(net.anchor_node.size());
  for (std::size_t i = 0; i < net.anchor_node.size(); ++i) {
    const Vector3d& X = model.rest[net.anchor_node[i]];
    const double share = model.anchor_share[i];
    loads.anchor_target[i] = share == 0 ? X : Vector3d(X + share * (X_CM * X - X));
    if (model.anchor_offset.empty()) continue;
    const Vector3d& offset = model.anchor_offset[i];
    loads.anchor_target[i] += offset + share * (X_CM.R * offset - offset);
  }
  loads.node_force = model.node_force;
  if (model.held_force.empty()) return loads;
  loads.node_force.resize(model.rest.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < model.rest.size(); ++i) {
    const Vector3d& held = model.held_force[i];
    if (held.isZero(0)) continue;
    const double share = model.node_share.empty() ? 0 : model.node_share[i];
    loads.node_force[i] += held + share * (X_CM.R * held - held);
  }
  return loads;
}

NetLoads touching_loads(const TissueModel& model, const Pose& X_CM, const Nodes& x) {
  NetLoads loads = loads_at(model, X_CM);
  set_contacts(look_at(model.contact, X_CM, x), loads);
  return loads;
}

namespace {

/// Iterations after which a factor of the tissue as it is now is made at once, and after twice as
/// many the next; later frames go on with it. It costs as much as some twenty of them.
constexpr int first_patience = 30;
/// Iterations of a frame above which one is made beside the loop; where frames end before they have
/// converged, iterations of all frames that the last one served.
constexpr int worth_making = 8, worth_making_of_all = 24;
/// After so many iterations contact is looked at anew, at the minimum or not: where tissue buckles,
/// planes laid before it gave way lead it astray (median of an opening 8 iterations either way,
/// 95th percentile 36 for 49).
constexpr int one_look = 8;
constexpr int most_looks = 40;
/// A frame whose contacts are farther off than this has not converged.
constexpr double well_touched_mm = 0.1;

/// The stored factor of the state on the path of opening that is nearest.
std::shared_ptr<const HessianFactor> path_factor(const TissueModel& model, const Pose& X_CM) {
  const double turned = rotation_angle(X_CM);
  const auto* nearest = &model.factors.front();
  for (const auto& other : model.factors)
    if (turned >= other.from_rad) nearest = &other;
  return nearest->factor;
}

int count_inverted(const SpringPrismNet& net, const Nodes& x) {
  int count = 0;
  for (const auto& prism : net.prisms) count += prism_volume(x, prism) <= 0;
  return count;
}

/// Where the step takes the nodes, to first order. As far as the step is plain opening or closing,
/// along the stored path; the rest of it takes each node its share of the mandible's way.
Nodes foreseen(const TissueModel& model, const TissueState& previous, const Pose& X_CM) {
  const OpeningPath& path = model.path;
  const double before = path.parameter(previous.X_CM), after = path.parameter(X_CM);
  const Pose rest_before = previous.X_CM * path.pose(before).inverse();
  const Pose rest_after = X_CM * path.pose(after).inverse();
  const auto from = path.weights(before), to = path.weights(after);
  Nodes nodes = previous.nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double share = model.node_share[i];
    const Vector3d x = previous.nodes[i];
    if (share != 0) nodes[i] += share * (rest_after * x - rest_before * x);
    if (path.nodes.empty()) continue;
    for (int k = 0; k < 4; ++k)
      nodes[i] +=
          to.weight[k] * path.nodes[to.knot[k]][i] - from.weight[k] * path.nodes[from.knot[k]][i];
  }
  return nodes;
}

}  // namespace

TissueState rest_tissue(const TissueModel& model) {
  TissueState state;
  state.nodes = model.rest;
  return state;
}

TissueState follow(const TissueModel& model, const TissueState& previous, const Pose& X_CM,
                   const TissueBudget& budget) {
  const auto keep = [&](const TissueState& failed) {
    TissueState kept = previous;
    kept.iterations = failed.iterations;
    kept.evaluations = failed.evaluations;
    kept.converged = false;
    kept.kept = true;
    return kept;
  };
  if (!X_CM.t.allFinite() || !X_CM.R.coeffs().allFinite()) return keep({});
  NetLoads loads = loads_at(model, X_CM);
  TissueState state;
  state.X_CM = X_CM;
  state.nodes = foreseen(model, previous, X_CM);
  if (count_inverted(model.net, state.nodes) > 0) state.nodes = previous.nodes;

  RollingFactor factor =
      previous.factor ? *previous.factor : RollingFactor(path_factor(model, X_CM));
  factor.advance();
  SpringPrismEnergy energy(model.net, loads, budget.threads, model.runs);
  int since_factor = 0, patience = first_patience;  // iterations
  const auto solve = [&] {
    MinimizeSettings settings;
    settings.tolerance_mm = budget.tolerance_mm;
    const int left = budget.max_iterations - state.iterations;
    settings.max_iterations =
        std::clamp(std::min(one_look, patience - since_factor), 1, std::max(left, 1));
    const MinimizeResult result =
        minimize(Method::preconditioned, energy, settings, state.nodes, &factor.now());
    state.iterations += result.iterations;
    state.evaluations += result.evaluations;
    since_factor += result.iterations;
    state.converged = result.converged();
    state.energy = result.energy;
    state.residual = result.residual;
    if (result.status != MinimizeResult::Status::budget_spent) return Solved::at_minimum;
    if (state.iterations >= budget.max_iterations) return Solved::spent;
    if (since_factor >= patience) {
      auto fresh = std::make_shared<HessianFactor>(factor.now());  // in the same order
      fresh->refactor(model.net, loads, state.nodes, budget.threads);
      factor.replace(std::move(fresh));
      since_factor = 0;
      patience *= 2;
    }
    return Solved::on_the_way;
  };
  Looks before;
  if (previous.touches) {
    before = *previous.touches;
    move_touches(X_CM * previous.X_CM.inverse(), before[on_mandible]);
  }
  const TouchingSettings contact_settings{.most_looks = most_looks,
                                          .tolerance_mm = 3 * budget.tolerance_mm,
                                          .gap_mm = 3 * budget.tolerance_mm,
                                          .rough_mm = well_touched_mm};
  NearJaws near = previous.near ? *previous.near : NearJaws{};
  TouchingResult touching = solve_touching(
      [&](const Nodes& x) {
        return look_at(model.contact, X_CM, x, budget.threads, &near, budget.contact_firmness);
      },
      solve, loads, state.nodes, contact_settings, before);
  factor.serve(state.iterations);
  if (state.iterations > worth_making ||
      (!state.converged && factor.served() > worth_making_of_all))
    factor.begin(model.net, loads, state.nodes, budget.threads, model.weak_from_this().lock());
  state.factor = std::make_shared<const RollingFactor>(std::move(factor));
  const ContactMeasure contact =
      measure_contact(model.contact, touching.looks, X_CM, model.rest, state.nodes);
  state.contact_error_mm = std::max(touching.error_mm, touching.gap_mm);
  state.converged = state.converged && state.contact_error_mm < well_touched_mm;
  state.near = std::make_shared<const NearJaws>(std::move(near));
  state.touches = std::make_shared<const Looks>(std::move(touching.looks));
  state.penetration_mm = contact.penetration_mm;
  state.slip_mm = contact.slip_mm;
  state.inverted_prisms = count_inverted(model.net, state.nodes);
  const bool usable = std::isfinite(state.energy) && state.inverted_prisms == 0 &&
                      std::all_of(state.nodes.begin(), state.nodes.end(),
                                  [](const Vector3d& p) { return p.allFinite(); });
  return usable ? state : keep(state);
}

}  // namespace condyle
