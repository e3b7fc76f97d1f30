#include "sim/contact/contact.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/collide/depenetration.h"
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/user_cache.h"
#include "sim/case/pair_rules.h"
#include "sim/contact/constrained_motion.h"
#include "sim/contact/contact_state.h"
#include "sim/contact/slider.h"

namespace condyle {
namespace {

constexpr int build_threads = 2;
constexpr double deep_start_mm = 0.5;
constexpr double least_noted_mm = 0.005;
constexpr double mixed_bones_mm = 3;  // crowns of one patient overlap by up to 1.2 mm

bool is_finite(const Pose& X) {
  return X.R.coeffs().allFinite() && X.t.allFinite() && std::abs(X.R.norm() - 1) < 1e-6;
}

void build_colliders(ContactModel::State& state, const Case& patient,
                     std::span<const std::shared_ptr<const ColliderShape>> earlier) {
  std::vector<int> parts;
  for (std::size_t i = 0; i < patient.parts.size(); ++i)
    if (collides(patient.parts[i].role) && !patient.parts[i].mesh.empty())
      parts.push_back(static_cast<int>(i));
  state.colliders.resize(parts.size());
  parallel_for(parts.size(), build_threads, [&](std::size_t i) {
    const auto part = static_cast<std::size_t>(parts[i]);
    const TriMesh& mesh = patient.parts[part].mesh;
    // Segments change with each edit of their plan.
    const auto cache =
        is_piece(patient.parts[part].role) ? std::filesystem::path() : user_cache_folder();
    state.colliders[i] =
        std::make_unique<Collider>(Collider{static_cast<int>(i), parts[i], patient.parts[part].body,
                                            false, ColliderShape::of(mesh, earlier, cache)});
  });
  state.pivot.assign(state.bodies.bodies().size(), Eigen::Vector3d::Zero());
  std::vector<double> largest(state.pivot.size(), -1);
  for (const auto& collider : state.colliders) {
    const std::size_t body = index_of(collider->body);
    if (collider->solid.radius() <= largest[body]) continue;
    largest[body] = collider->solid.radius();
    state.pivot[body] = collider->solid.center();
  }
}

void build_pairs(ContactModel::State& state, const Case& patient) {
  for (const auto& a : state.colliders)
    for (const auto& b : state.colliders) {
      if (a->body >= b->body) continue;
      const auto rule = rule_for(patient, state.settings.pair_rules,
                                 patient.parts[static_cast<std::size_t>(a->part)],
                                 patient.parts[static_cast<std::size_t>(b->part)]);
      state.pairs.push_back({.a = a.get(), .b = b.get(), .policy = rule.policy});
      state.rules.push_back(rule);
    }
}

/// Advice for a body that starts deep inside another.
std::string deep_start_note(const ColliderPair& pair, const Case& patient, double depth_mm) {
  const auto& name = [&](const Collider& of) {
    return patient.parts[static_cast<std::size_t>(of.part)].name;
  };
  const Depenetration out =
      push_out({pair.a->surface, pair.a->solid}, {}, {pair.b->surface, pair.b->solid}, {});
  const std::string start =
      fmt::format("{} starts {:.1f} mm deep inside {}", name(*pair.b), depth_mm, name(*pair.a));
  if (out.status != Depenetration::Status::found)
    return start + "; no exit is defined, because one of them is an open surface";
  const Eigen::Vector3d shift = out.length_mm * out.direction;
  return start + fmt::format(
                     "; moved by ({:.1f}, {:.1f}, {:.1f}) mm it would be clear of this "
                     "one; to have it clear of all, import it again with --push-out",
                     shift.x(), shift.y(), shift.z());
}

PairContact carried(PairContact found, const Pose& X) {
  for (ContactPoint& contact : found.contacts) {
    contact.point = X * contact.point;
    contact.normal = X.R * contact.normal;
  }
  found.witness_a = X * found.witness_a;
  found.witness_b = X * found.witness_b;
  return found;
}

/// Whether the two are segments of one bone that overlap at the planned positions.
bool is_trimmed(const ColliderPair& pair, const Case& patient) {
  const auto grafted = [&](const Collider& one) {
    return patient.parts[static_cast<std::size_t>(one.part)].role == Role::transplant;
  };
  return pair.policy == PairPolicy::cut_face && pair.rest_depth_mm > deep_mm && !grafted(*pair.a) &&
         !grafted(*pair.b);
}

/// Overlap at rest becomes the pairs' baseline; a complement monitors the surface outside it.
void find_baseline(ContactModel::State& state, const Case& patient) {
  const BodyPoses at_rest = completed(state.bodies, {});
  state.rest = state.query_all(at_rest, nullptr, build_threads);
  state.mixed.assign(state.bodies.bodies().size(), false);
  for (std::size_t i = 0; i < state.pairs.size(); ++i) {
    ColliderPair& pair = state.pairs[i];
    PairContact& rest = state.rest.pairs[i];
    pair.apart_at_rest = !rest.touching;
    pair.rest_depth_mm = rest.rest_depth_mm = rest.depth_mm;
    if (pair.policy == PairPolicy::guided)
      pair.min_distance_mm = std::min(state.rules[i].gap_mm, rest.distance_mm);
    pair.obstructs = !is_trimmed(pair, patient);
    if (!rest.touching) continue;
    const TriMesh& mesh = patient.parts[static_cast<std::size_t>(rest.part_b)].mesh;
    const bool mixed = state.in_joint(pair) && rest.depth_mm > mixed_bones_mm;
    if (rest.depth_mm >= least_noted_mm)
      state.notes.push_back(fmt::format(
          "{} and {} overlap by {:.2f} mm at rest{}: taken as the baseline, only deeper contact "
          "counts",
          patient.parts[static_cast<std::size_t>(rest.part_a)].name,
          patient.parts[static_cast<std::size_t>(rest.part_b)].name, rest.depth_mm,
          mixed
              ? ", more than jaws of one patient do (check that both are of the same patient, unit "
                "and frame; until then the jaw stops where they meet and does not slide)"
              : ""));
    if (mixed) state.mixed[index_of(pair.b->body)] = true;
    if (state.settings.advise_exits && !state.in_joint(pair) && rest.depth_mm > deep_start_mm)
      state.notes.push_back(deep_start_note(pair, patient, rest.depth_mm));
    const TriMesh away = away_from_overlap(mesh, overlap_at_rest(pair));
    if (away.empty()) continue;
    state.colliders.push_back(std::make_unique<Collider>(
        Collider{static_cast<int>(state.colliders.size()), rest.part_b, pair.b->body, true,
                 std::make_shared<const ColliderShape>(away)}));
    state.colliders.back()->whole = &pair.b->solid;
    state.colliders.back()->part_tree = std::make_unique<const TriangleTree>(away);
    const ColliderPair complement{.a = pair.a,
                                  .b = state.colliders.back().get(),
                                  .policy = pair.policy,
                                  .obstructs = pair.obstructs};
    if (query_pair(complement, {}, {}, {}, {.need_depth = false}).touching)
      continue;  // entirely inside at rest: nothing remains
    state.complements.push_back(complement);
    state.complement_of.push_back(i);
  }
  const bool joints_alone = std::all_of(state.pairs.begin(), state.pairs.end(),
                                        [&](const auto& pair) { return state.in_joint(pair); });
  if (!joints_alone && state.settings.far_mm < nowhere_mm) {
    std::vector<const CollisionMesh*> surfaces;
    for (const auto& collider : state.colliders) surfaces.push_back(&collider->surface);
    state.broadphase.emplace(surfaces);
  }
  state.rest = state.query_all(at_rest, &state.rest, build_threads);
  state.rest_known = true;
}

}  // namespace

BodyPoses ContactModel::State::complete(const BodyPoses& given) const {
  BodyPoses at = completed(bodies, given);
  if (!std::all_of(at.X_CB.begin(), at.X_CB.end(), is_finite))
    throw InputError(
        "a pose has values that are not finite, or an invalid rotation; the bones "
        "cannot be placed there");
  return at;
}

std::vector<bool> ContactModel::State::far_pairs(const BodyPoses& at) const {
  std::vector<bool> far(count(), false);
  if (!broadphase) return far;
  std::vector<Pose> poses;
  for (const auto& collider : colliders) poses.push_back(at[collider->body]);
  const std::vector<BodyPair> near = broadphase->near(poses, settings.far_mm);
  for (std::size_t i = 0; i < far.size(); ++i) {
    const ColliderPair& pair = pair_or_complement(i);
    const BodyPair sought{std::min(pair.a->number, pair.b->number),
                          std::max(pair.a->number, pair.b->number)};
    far[i] = !in_joint(pair) && !std::binary_search(near.begin(), near.end(), sought);
  }
  return far;
}

ContactSet ContactModel::State::query_all(const BodyPoses& at, const ContactSet* previous,
                                          int threads, Distances distances) const {
  ContactSet set;
  set.at = at;
  set.pairs.resize(pairs.size());
  set.outside_rest_overlap.resize(complements.size());
  const std::vector<bool> far = far_pairs(at);
  parallel_for(count(), threads, [&](std::size_t i) {
    const ColliderPair& pair = pair_or_complement(i);
    const Pose &X_CA = at[pair.a->body], &X_CB = at[pair.b->body];
    if (rest_known && bit_identical(X_CA, X_CB))
      slot(set, i) = carried(slot(rest, i), X_CA);
    else if (far[i])
      slot(set, i) = far_apart(pair, settings.far_mm);
    else {
      QueryOptions query = full_query(i);
      query.need_distance = distances == Distances::all;
      slot(set, i) = query_pair(pair, X_CA, X_CB, start(previous, i), query);
    }
  });
  return set;
}

void ContactModel::State::measure_bounds(const BodyPoses& at, ContactSet& set) const {
  for (std::size_t i = 0; i < count(); ++i) {
    PairContact& found = slot(set, i);
    if (!found.distance_is_bound || found.distance_mm >= full_query(i).far_mm) continue;
    const ColliderPair& pair = pair_or_complement(i);
    found = query_pair(pair, at[pair.a->body], at[pair.b->body],
                       {found.triangle_a, found.triangle_b}, full_query(i));
  }
}

ContactSet ContactModel::State::with_complements(ContactSet set) const {
  for (std::size_t g = 0; g < complements.size(); ++g) {
    if (!set.outside_rest_overlap[g].touching) continue;
    PairContact& pair = set.pairs[complement_of[g]];
    const PairContact& away = set.outside_rest_overlap[g];
    if (pair.rest_depth_mm + away.depth_mm <= pair.depth_mm) continue;
    pair.depth_mm = pair.rest_depth_mm + away.depth_mm;
    pair.witness_a = away.witness_a;
    pair.witness_b = away.witness_b;
  }
  return set;
}

ContactModel::ContactModel(const Case& patient, const ContactSettings& settings,
                           const ContactModel* earlier) {
  const auto made = std::make_shared<State>();
  State& state = *made;
  state_ = made;
  state.settings = settings;
  check_rules(patient, patient.pair_rules, "the case's rule for");
  check_rules(patient, settings.pair_rules, "the rule for");
  state.bodies = patient.bodies;
  std::vector<std::shared_ptr<const ColliderShape>> shapes;
  if (earlier)
    for (const auto& collider : earlier->state_->colliders) shapes.push_back(collider->shape);
  build_colliders(state, patient, shapes);
  for (const auto& collider : state.colliders)
    if (const Solid& solid = collider->solid; solid.open_shell_count() > 0)
      state.notes.push_back(fmt::format(
          "{}: {} of {} pieces are open surfaces without an inside; their depth of overlap is "
          "measured by the crossing triangles only",
          patient.parts[static_cast<std::size_t>(collider->part)].name, solid.open_shell_count(),
          solid.shell_count()));
  build_pairs(state, patient);
  find_baseline(state, patient);
  state.slider =
      std::make_unique<Slider>(patient, state, earlier ? earlier->state_->slider.get() : nullptr);
}

ContactModel ContactModel::none(const BodyTree& bodies) {
  Case bare;
  bare.bodies = bodies;
  return ContactModel(bare);
}

ContactSet ContactModel::find(const BodyPoses& at, const ContactSet* previous, int threads) const {
  return state_->with_complements(state_->query_all(state_->complete(at), previous, threads));
}

ContactSet ContactModel::find_touching(const BodyPoses& at, int threads) const {
  return state_->with_complements(
      state_->query_all(state_->complete(at), nullptr, threads, Distances::of_touching));
}

namespace {

/// Whether the set was taken at these poses, without the complements included in its depths.
bool taken_at(const ContactModel::State& state, const ContactSet* set, const BodyPoses& at) {
  if (!state.fits(set)) return false;
  for (const auto& complement : set->outside_rest_overlap)
    if (complement.touching) return false;
  return std::equal(set->at.X_CB.begin(), set->at.X_CB.end(), at.X_CB.begin(), at.X_CB.end(),
                    bit_identical);
}

/// Whether all pairs are across one joint: then an answer from another pose is as good a start as
/// one from this pose.
bool is_one_joint(const ContactModel::State& state) { return state.bodies.size() == 2; }

/// The pairs that a move changes but does not measure: of bodies that were moved as one, whose
/// answers stay behind, and of segments that overlap as planned.
class CarriedPairs {
 public:
  explicit CarriedPairs(const ContactModel::State& state)
      : state_(state), carried_(state.count(), false) {}

  void note(const BodyMove& move, const BodyPoses& reached) {
    if (bit_identical(move.from(), reached[move.body])) return;
    for (std::size_t i = 0; i < carried_.size(); ++i) {
      const ColliderPair& pair = state_.pair_or_complement(i);
      if (move.obstructed_by(pair))
        carried_[i] = false;
      else if (move.moves[index_of(pair.a->body)] || move.moves[index_of(pair.b->body)])
        carried_[i] = true;
    }
  }

  /// Brings the answers to the poses, for all of which `set.at` stands. Where two bodies lie as at
  /// rest, so does their answer, whatever came between.
  void bring_along(ContactSet& set, int threads) const {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < carried_.size(); ++i)
      if (carried_[i]) all.push_back(i);
    parallel_for(all.size(), threads, [&](std::size_t k) {
      const std::size_t i = all[k];
      const ColliderPair& pair = state_.pair_or_complement(i);
      const Pose &X_CA = set.at[pair.a->body], &X_CB = set.at[pair.b->body];
      PairContact& found = state_.slot(set, i);
      found = bit_identical(X_CA, X_CB)
                  ? carried(state_.slot(state_.rest, i), X_CA)
                  : query_pair(pair, X_CA, X_CB, {found.triangle_a, found.triangle_b},
                               state_.full_query(i));
    });
  }

 private:
  const ContactModel::State& state_;
  std::vector<bool> carried_;
};

}  // namespace

ContactModel::Slide ContactModel::stop_at_contact(const BodyPoses& from, const Pose& target,
                                                  const ContactSet* previous, int threads,
                                                  BodyId body) const {
  const State& state = *state_;
  state.complete(BodyPoses(target));  // refuses values that are not finite
  const BodyPoses start = state.complete(from);
  // An answer from another pose still accelerates the queries.
  const bool known = taken_at(state, previous, start);
  const bool near = is_one_joint(state) && state.fits(previous);
  ContactSet set = known || near ? *previous : state.query_all(start, previous, threads);
  const bool exact = known || !near;
  const BodyMove move = make_move(state, start, body, target);
  const MoveResult reached = stop(state, move, set, exact, threads);
  set.at = move.poses_at(reached.X_CD);
  CarriedPairs pairs(state);
  pairs.note(move, set.at);
  pairs.bring_along(set, threads);
  BodyPoses there = set.at;
  return {std::move(there), reached.stopped, state.with_complements(std::move(set))};
}

BodyPoses ContactModel::placed(std::span<const Pose> X_PB_target) const {
  return condyle::placed(state_->bodies, X_PB_target);
}

void ContactModel::prepare_sliding(const Progress& progress, int threads) const {
  state_->slider->prepare(progress, threads);
}

ContactModel::Slide ContactModel::slide(const BodyPoses& from, std::span<const Pose> X_PB_target,
                                        const ContactSet* previous, int threads,
                                        bool bound_far) const {
  const State& state = *state_;
  Slide result;
  BodyPoses& at = result.at;
  at = state.complete(from);
  state.complete(placed(X_PB_target));  // refuses invalid poses
  bool exact = taken_at(state, previous, at);
  const bool near = is_one_joint(state) && state.fits(previous);
  ContactSet set = exact || near ? *previous : state.query_all(at, previous, threads);
  exact = exact || !near;
  CarriedPairs pairs(state);
  for (int b = 1; b < state.bodies.size(); ++b) {
    const BodyId body{b};
    // Relative to the pose that the parent reached.
    const Pose to =
        composed(at[state.bodies[body].parent],
                 index_of(body) < X_PB_target.size() ? X_PB_target[index_of(body)] : Pose{});
    if (!state.bodies.moved_by_motion(body) && bit_identical(at[body], to)) continue;
    const BodyMove move = make_move(state, at, body, to);
    const MoveResult reached = slide_move(state, move, set, exact, bound_far, threads);
    at = move.poses_at(reached.X_CD);
    pairs.note(move, at);
    exact = true;
    result.stopped |= reached.stopped;
  }
  if (!bound_far) state.measure_bounds(at, set);
  set.at = at;
  pairs.bring_along(set, threads);
  result.contacts = state.with_complements(std::move(set));
  return result;
}

const ContactSet& ContactModel::at_rest() const { return state_->rest; }
const std::vector<PairRule>& ContactModel::rules() const { return state_->rules; }
const std::vector<std::string>& ContactModel::notes() const { return state_->notes; }

}  // namespace condyle
