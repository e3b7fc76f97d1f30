#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <tuple>
#include <utility>

#include "engine/minimize/minimize.h"
#include "sim/frame/body_poses.h"
#include "sim/tissue/model.h"
#include "sim/tissue/path_factors.h"
#include "sim/tissue/pose_steps.h"
#include "sim/tissue/solver_cache.h"

namespace condyle {

using Eigen::Vector3d;

std::vector<Pose> poses_from_mesh(const PlannedRest* planned, std::span<const Pose> X_CB) {
  std::vector<Pose> from_mesh(X_CB.begin(), X_CB.end());
  if (!planned) return from_mesh;
  from_mesh.resize(std::max(X_CB.size(), planned->X_CB.size()));
  for (std::size_t b = 0; b < planned->X_CB.size(); ++b)
    from_mesh[b] = composed(from_mesh[b], planned->X_CB[b]);
  return from_mesh;
}

std::vector<Pose> poses_from_mesh(const TissueModel& model, std::span<const Pose> X_CB) {
  return poses_from_mesh(model.planned.get(), X_CB);
}

MeshLoads loads_at(const TissueModel& model, std::span<const Pose> X_CB_now,
                   std::span<const double> excitation) {
  const std::vector<Pose> X_CB = poses_from_mesh(model, X_CB_now);
  const auto& [elements, rest] = std::tie(model.mesh->elements, model.mesh->rest);
  const TissueSupport& support = model.support;
  MeshLoads loads;
  if (!excitation.empty()) {
    loads.muscles = muscle_pull(model.muscles, excitation, X_CB);
    loads.anchor_scale = anchor_scales(model.muscles, excitation, elements.anchor_node.size());
  }
  loads.anchor_target.resize(elements.anchor_node.size());
  for (std::size_t i = 0; i < elements.anchor_node.size(); ++i) {
    const Vector3d& X = rest[elements.anchor_node[i]];
    loads.anchor_target[i] = X + carried_by(support.anchor[i], X_CB, X);
    if (!support.anchor_offset.empty())
      loads.anchor_target[i] += turned_by(support.anchor[i], X_CB, support.anchor_offset[i]) /
                                (loads.anchor_scale.empty() ? 1 : loads.anchor_scale[i]);
  }
  loads.node_force = support.node_force;
  if (support.held_force.empty()) return loads;
  loads.node_force.resize(rest.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (!support.held_force[i].isZero(0))
      loads.node_force[i] += turned_by(support.node[i], X_CB, support.held_force[i]);
  return loads;
}

int count_inverted(const SpringPrismMesh& elements, const Nodes& x) {
  int count = 0;
  for (const auto& prism : elements.prisms) count += prism_volume(x, prism) <= 0;
  return count;
}

MeshLoads contact_loads(const TissueModel& model, std::span<const Pose> X_CB, const Nodes& x) {
  MeshLoads loads = loads_at(model, X_CB);
  set_contacts(find_tissue_contacts(*model.contact, model.mesh->own_stiffness,
                                    poses_from_mesh(model, X_CB), x),
               loads);
  return loads;
}

namespace {

/// After this many iterations of a frame the tissue is refactored at its current state, and again
/// after twice as many; later frames use the new factor. A refactorization costs as much as about
/// twenty iterations.
constexpr int first_refactoring = 30;
/// After more iterations than this in a frame, a factor is computed asynchronously; where frames
/// end unconverged, after this many iterations of all frames that used the last factor.
constexpr int refactor_beside_loop_after = 8, refactor_beside_loop_after_all = 24;
/// After this many iterations contacts are searched again, at the minimum or not: where tissue
/// buckles, contact planes from before the buckling mislead the solver (median of an opening 8
/// iterations with or without, 95th percentile 36 instead of 49).
constexpr int iterations_per_contact = 8;
/// The same where the last search changed contacts by no more than their tolerances: a minimizer
/// that is not restarted converges sooner (frames of a smile 69 iterations instead of 81).
constexpr int iterations_per_settled_contact = 32;
constexpr int max_contact_rounds = 40;
/// A frame whose contacts are off by more than this has not converged.
constexpr double accepted_contact_mm = 0.1;

}  // namespace

TissueState rest_tissue(const TissueModel& model) {
  TissueState state;
  state.nodes = model.planned ? model.planned->nodes : model.mesh->rest;
  return state;
}

namespace {

/// The minimizer of one frame, whose preconditioner is refactored when it is out of date.
class FrameSolve {
 public:
  FrameSolve(const TissueModel& model, const MeshLoads& loads, const TissueBudget& budget,
             AsyncPreconditioner& factor, TissueState& state)
      : model_(model),
        loads_(loads),
        budget_(budget),
        factor_(factor),
        state_(state),
        energy_(model.mesh->elements, loads, budget.threads, model.mesh->runs) {}

  /// A number of iterations under the current loads; more where the contacts in them are settled.
  Solved operator()(bool contacts_settled) {
    MinimizeSettings settings;
    settings.tolerance_mm = budget_.tolerance_mm;
    const int left = budget_.max_iterations - state_.iterations;
    const int per_contact =
        contacts_settled ? iterations_per_settled_contact : iterations_per_contact;
    settings.max_iterations =
        std::clamp(std::min(per_contact, refactor_after_ - since_factor_), 1, std::max(left, 1));
    settings.check_last = settings.max_iterations < left;
    const MinimizeResult result = minimize(energy_, factor_.now(), settings, state_.nodes);
    state_.iterations += result.iterations;
    state_.evaluations += result.evaluations;
    since_factor_ += result.iterations;
    state_.converged = result.converged();
    state_.energy = result.energy;
    state_.residual = result.residual;
    if (result.status != MinimizeResult::Status::budget_spent) return Solved::at_minimum;
    if (state_.iterations >= budget_.max_iterations) return Solved::budget_spent;
    if (since_factor_ >= refactor_after_) refactor();
    return Solved::in_progress;
  }

 private:
  void refactor() {
    auto fresh = std::make_shared<HessianFactor>(factor_.now());  // in the same order
    fresh->refactor(model_.mesh->elements, loads_, state_.nodes, budget_.threads);
    factor_.replace(std::move(fresh));
    since_factor_ = 0;
    refactor_after_ *= 2;
  }

  const TissueModel& model_;
  const MeshLoads& loads_;
  const TissueBudget& budget_;
  AsyncPreconditioner& factor_;
  TissueState& state_;
  SpringPrismEnergy energy_;
  int since_factor_ = 0, refactor_after_ = first_refactoring;  // iterations
};

/// The contacts that a frame starts with: those of the last frame, moved with the bones.
ContactLists moved_contacts(const TissueModel& model, const SolverCache* last,
                            std::span<const Pose> X_CB) {
  if (!last) return {};
  ContactLists touches = last->touches;
  const auto& obstacles = model.contact->obstacles;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const BodyId body = obstacles[i].body;
    move_contacts(pose_in(X_CB, body) * pose_in(last->X_CB, body).inverse(), touches[i]);
  }
  return touches;
}

bool all_finite(std::span<const Pose> X_CB) {
  return std::all_of(X_CB.begin(), X_CB.end(),
                     [](const Pose& X) { return X.t.allFinite() && X.R.coeffs().allFinite(); });
}

bool usable(const TissueState& state) {
  return std::isfinite(state.energy) && state.inverted_prisms == 0 &&
         std::all_of(state.nodes.begin(), state.nodes.end(),
                     [](const Vector3d& p) { return p.allFinite(); });
}

/// The state of a frame whose solve failed: that of the previous frame.
TissueState previous_state(const TissueState& previous, const TissueState& failed) {
  TissueState state = previous;
  state.iterations = failed.iterations;
  state.evaluations = failed.evaluations;
  state.converged = false;
  state.reused = true;
  return state;
}

/// Between two excitations, without them: muscles that pull at once would tear tissue through its
/// contacts.
std::vector<std::vector<double>> excitation_steps(std::span<const double> from,
                                                  std::span<const double> to) {
  constexpr double step = 0.2;
  const auto of = [](std::span<const double> list, std::size_t i) {
    return i < list.size() ? list[i] : 0;
  };
  const std::size_t muscles = std::max(from.size(), to.size());
  double most = 0;
  for (std::size_t i = 0; i < muscles; ++i)
    most = std::max(most, std::abs(of(to, i) - of(from, i)));
  const int count = static_cast<int>(std::ceil(most / step));
  std::vector<std::vector<double>> steps;
  for (int k = 1; k < count; ++k) {
    std::vector<double>& between = steps.emplace_back();
    for (std::size_t i = 0; i < muscles; ++i)
      between.push_back(of(from, i) + (of(to, i) - of(from, i)) * k / count);
  }
  return steps;
}

/// Whether a prism is too thin to start from: the barrier against inversion would dwarf all else.
bool any_collapsed(const SpringPrismMesh& elements, const Nodes& x) {
  constexpr double least_volume = 0.01;  // of that at rest
  for (std::size_t i = 0; i < elements.prisms.size(); ++i)
    if (prism_volume(x, elements.prisms[i]) <= least_volume * elements.rest_volume[i]) return true;
  return false;
}

/// One step to finite poses.
TissueState solve_step(const TissueModel& model, const TissueState& previous,
                       std::span<const Pose> X_CB, std::span<const double> excitation,
                       const TissueBudget& budget, TissueWarmStart& warm) {
  const auto& [mesh, contact] = std::tie(*model.mesh, *model.contact);
  const std::vector<Pose> from_mesh = poses_from_mesh(model, X_CB);
  MeshLoads loads = loads_at(model, X_CB, excitation);
  TissueState state;
  state.X_CB.assign(X_CB.begin(), X_CB.end());
  state.excitation.assign(excitation.begin(), excitation.end());
  state.nodes = model.opening.extrapolated(previous.nodes, model.support.node, previous.X_CB, X_CB);
  if (any_collapsed(mesh.elements, state.nodes)) state.nodes = previous.nodes;

  const SolverCache* last = warm.last.get();
  AsyncPreconditioner factor = last && last->mesh == model.mesh
                                   ? last->factor
                                   : AsyncPreconditioner(model.factors->nearest(
                                         rotation_angle(pose_in(X_CB, model.opening.body))));
  factor.advance();
  if (last && last->contact != model.contact) last = nullptr;  // of other obstacles
  NearObstacles near = last ? last->near : NearObstacles{};
  const ContactSolveSettings contact_settings{.max_contact_searches = max_contact_rounds,
                                              .tolerance_mm = 3 * budget.tolerance_mm,
                                              .gap_mm = 3 * budget.tolerance_mm,
                                              .rough_mm = accepted_contact_mm,
                                              .relaxed = budget.relaxed_contact,
                                              .damped = budget.damped_contact};
  FrameSolve solve(model, loads, budget, factor, state);
  ContactSolveResult touching = solve_contact(
      [&](const Nodes& x) {
        return find_tissue_contacts(contact, mesh.own_stiffness, from_mesh, x, budget.threads,
                                    &near, budget.contact_firmness);
      },
      [&](bool contacts_settled) { return solve(contacts_settled); }, loads, state.nodes,
      contact_settings, moved_contacts(model, last, X_CB));
  factor.add_iterations(state.iterations);
  if (state.iterations > refactor_beside_loop_after ||
      (!state.converged && factor.iterations_used() > refactor_beside_loop_after_all))
    factor.begin(mesh.elements, loads, state.nodes, budget.threads, model.mesh, state.iterations);
  const ContactMeasure measured =
      measure_contact(contact, touching.contacts, from_mesh, mesh.rest, state.nodes);
  state.contact_error_mm = std::max(touching.error_mm, touching.gap_mm);
  state.converged = state.converged && state.contact_error_mm < accepted_contact_mm;
  state.penetration_mm = measured.penetration_mm;
  state.slip_mm = measured.slip_mm;
  state.inverted_prisms = count_inverted(mesh.elements, state.nodes);
  if (!usable(state)) return previous_state(previous, state);
  warm.last =
      std::make_shared<const SolverCache>(SolverCache{.X_CB = state.X_CB,
                                                      .mesh = model.mesh,
                                                      .contact = model.contact,
                                                      .factor = std::move(factor),
                                                      .touches = std::move(touching.contacts),
                                                      .near = std::move(near)});
  return state;
}

}  // namespace

TissueState solve_tissue(const TissueModel& model, const TissueState& previous,
                         std::span<const Pose> X_CB, const TissueBudget& budget,
                         TissueWarmStart& warm, std::span<const double> excitation) {
  assert(previous.nodes.size() == model.mesh->rest.size());
  assert(budget.tolerance_mm > 0 && budget.max_iterations > 0);
  if (!all_finite(X_CB)) return previous_state(previous, {});
  TissueState state = previous;
  TissueWarmStart reached = warm;
  int iterations = 0, evaluations = 0;
  const auto go_to = [&](std::span<const Pose> X_CB_step, std::span<const double> of_step) {
    state = solve_step(model, state, X_CB_step, of_step, budget, reached);
    state.iterations = iterations += state.iterations;
    state.evaluations = evaluations += state.evaluations;
    return !state.reused;
  };
  for (const auto& of_step : excitation_steps(previous.excitation, excitation))
    if (!go_to(previous.X_CB, of_step)) return previous_state(previous, state);
  for (const auto& X_CB_step : pose_steps(model, previous.X_CB, X_CB))
    if (!go_to(X_CB_step, excitation)) return previous_state(previous, state);
  warm = std::move(reached);
  return state;
}

TissueState solve_tissue(const TissueModel& model, const TissueState& previous,
                         std::span<const Pose> X_CB, const TissueBudget& budget) {
  TissueWarmStart none;
  return solve_tissue(model, previous, X_CB, budget, none);
}

}  // namespace condyle
