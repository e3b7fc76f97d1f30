#include <algorithm>

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
  }
  for (const auto& slide : model.slides) {
    const Vector3d normal = slide.on_mandible ? Vector3d(X_CM.R * slide.normal) : slide.normal;
    const Vector3d point = slide.on_mandible ? X_CM * slide.point : slide.point;
    loads.contacts.push_back(
        ContactRow::of_node(slide.node, normal, normal.dot(point), slide.stiffness));
  }
  return loads;
}

namespace {

/// Iterations after which a factor of the tissue as it is now, worth some thirty of them, is made.
constexpr int patience = 25;

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
  const NetLoads loads = loads_at(model, X_CM);
  TissueState state;
  state.X_CM = X_CM;
  state.nodes = foreseen(model, previous, X_CM);
  if (count_inverted(model.net, state.nodes) > 0) state.nodes = previous.nodes;

  const double turned = rotation_angle(X_CM);
  const HessianFactor* factor = &model.factors.front().factor;
  for (const auto& other : model.factors)
    if (turned >= other.from_rad) factor = &other.factor;
  MinimizeSettings settings;
  settings.tolerance_mm = budget.tolerance_mm;
  settings.max_iterations = std::min(budget.max_iterations, patience);
  SpringPrismEnergy energy(model.net, loads, budget.threads);
  MinimizeResult result = minimize(Method::preconditioned, energy, settings, state.nodes, factor);
  if (!result.converged() && budget.max_iterations > patience) {
    const MinimizeResult first = result;
    const HessianFactor fresh(model.net, loads, model.sheets, state.nodes);
    settings.max_iterations = budget.max_iterations - patience;
    result = minimize(Method::preconditioned, energy, settings, state.nodes, &fresh);
    result.iterations += first.iterations;
    result.evaluations += first.evaluations;
  }
  state.iterations = result.iterations;
  state.evaluations = result.evaluations;
  state.converged = result.converged();
  state.energy = result.energy;
  state.residual = result.residual;
  state.inverted_prisms = count_inverted(model.net, state.nodes);
  return state;
}

}  // namespace condyle
