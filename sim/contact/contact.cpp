#include "sim/contact/contact.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/collide/push_out.h"
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "sim/case/pair_rules.h"
#include "sim/contact/contact_state.h"
#include "sim/contact/drive.h"
#include "sim/contact/slider.h"

namespace condyle {
namespace {

constexpr int build_threads = 2;
constexpr double deep_start_mm = 0.5;
constexpr double mixed_bones_mm = 3;  // crowns of one patient overlap by up to 1.2 mm

bool is_finite(const Pose& X) {
  return X.R.coeffs().allFinite() && X.t.allFinite() && std::abs(X.R.norm() - 1) < 1e-6;
}

/// The number of each part's body.
std::vector<int> body_numbers(const std::vector<Part>& parts) {
  std::vector<int> bodies(parts.size(), cranium_body);
  int next = first_free_body;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Body body = body_of(parts[i].role);
    if (body == Body::mandible) bodies[i] = mandible_body;
    if (body == Body::free) bodies[i] = next++;
  }
  return bodies;
}

void build_colliders(ContactModel::State& state, const Case& patient) {
  const std::vector<int> bodies = body_numbers(patient.parts);
  std::vector<int> parts;
  for (std::size_t i = 0; i < patient.parts.size(); ++i)
    if (collides(patient.parts[i].role) && !patient.parts[i].mesh.empty())
      parts.push_back(static_cast<int>(i));
  state.colliders.resize(parts.size());
  parallel_for(parts.size(), build_threads, [&](std::size_t i) {
    const auto part = static_cast<std::size_t>(parts[i]);
    const TriMesh& mesh = patient.parts[part].mesh;
    state.colliders[i] = std::make_unique<Collider>(Collider{
        static_cast<int>(i), parts[i], bodies[part], false, CollisionMesh(mesh), Solid(mesh)});
  });
  state.pivot.assign(static_cast<std::size_t>(state.body_count()), Eigen::Vector3d::Zero());
  std::vector<double> largest(state.pivot.size(), -1);
  for (const auto& collider : state.colliders) {
    const auto body = static_cast<std::size_t>(collider->body);
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
      state.pairs.push_back({a.get(), b.get(), rule.policy, true, 0, 0});
      state.rules.push_back(rule);
    }
}

/// What a free part that starts deep inside another can do about it.
std::string deep_start_note(const ColliderPair& pair, const Case& patient, double depth_mm) {
  const auto& name = [&](const Collider& of) {
    return patient.parts[static_cast<std::size_t>(of.part)].name;
  };
  const PushOut out =
      push_out({pair.a->surface, pair.a->solid}, {}, {pair.b->surface, pair.b->solid}, {});
  const std::string start =
      fmt::format("{} starts {:.1f} mm deep inside {}", name(*pair.b), depth_mm, name(*pair.a));
  if (out.status != PushOut::Status::found)
    return start + "; a way out cannot be told, for one of them is an open surface";
  const Eigen::Vector3d way = out.length_mm * out.direction;
  return start + fmt::format(
                     "; moved by ({:.1f}, {:.1f}, {:.1f}) mm it would be clear of this "
                     "one; to have it clear of all, import it again with --push-out",
                     way.x(), way.y(), way.z());
}

/// Overlap at rest becomes the pairs' baseline; where there is some, a guard watches the rest.
void find_baseline(ContactModel::State& state, const Case& patient) {
  const std::vector<Pose> at_rest(static_cast<std::size_t>(state.body_count()));
  state.rest = state.judge_all(at_rest, nullptr, 1);
  for (std::size_t i = 0; i < state.pairs.size(); ++i) {
    ColliderPair& pair = state.pairs[i];
    PairContact& rest = state.rest.pairs[i];
    pair.apart_at_rest = !rest.touching;
    pair.rest_depth_mm = rest.rest_depth_mm = rest.depth_mm;
    if (pair.policy == PairPolicy::guided)
      pair.kept_mm = std::min(state.rules[i].gap_mm, rest.distance_mm);
    if (!rest.touching) continue;
    const TriMesh& mesh = patient.parts[static_cast<std::size_t>(rest.part_b)].mesh;
    const bool mixed = pair.b->body < first_free_body && rest.depth_mm > mixed_bones_mm;
    state.notes.push_back(fmt::format(
        "{} and {} overlap by {:.2f} mm at rest{}: taken as the baseline, only deeper contact "
        "counts",
        patient.parts[static_cast<std::size_t>(rest.part_a)].name,
        patient.parts[static_cast<std::size_t>(rest.part_b)].name, rest.depth_mm,
        mixed ? ", more than jaws of one patient do (check that both are of the same patient, unit "
                "and frame)"
              : ""));
    if (pair.b->body >= first_free_body && rest.depth_mm > deep_start_mm)
      state.notes.push_back(deep_start_note(pair, patient, rest.depth_mm));
    const TriMesh away = away_from_overlap(mesh, overlap_at_rest(pair));
    if (away.empty()) continue;
    state.colliders.push_back(
        std::make_unique<Collider>(Collider{static_cast<int>(state.colliders.size()), rest.part_b,
                                            pair.b->body, true, CollisionMesh(away), Solid(away)}));
    const ColliderPair guard{pair.a, state.colliders.back().get(), pair.policy, true, 0, 0};
    if (judge(guard, {}, {}, {}, {.need_depth = false}).touching)
      continue;  // wholly inside at rest: nothing to guard
    state.guards.push_back(guard);
    state.guarded.push_back(i);
  }
  if (!state.carrier.empty() && state.settings.far_mm < nowhere_mm) {
    std::vector<const CollisionMesh*> surfaces;
    for (const auto& collider : state.colliders) surfaces.push_back(&collider->surface);
    state.broadphase.emplace(surfaces);
  }
  state.rest = state.judge_all(at_rest, &state.rest, 1);
}

}  // namespace

bool same_bits(const Pose& x, const Pose& y) { return x.R.coeffs() == y.R.coeffs() && x.t == y.t; }

std::vector<Pose> ContactModel::State::body_poses(const BodyPoses& at) const {
  std::vector<Pose> poses(static_cast<std::size_t>(body_count()));
  poses[mandible_body] = at.X_CM;
  for (std::size_t f = 0; f < carrier.size(); ++f)
    poses[first_free_body + f] = f < at.X_CF.size()             ? at.X_CF[f]
                                 : carrier[f] == Body::mandible ? at.X_CM
                                                                : Pose{};
  if (!std::all_of(poses.begin(), poses.end(), is_finite))
    throw InputError(
        "a pose has values that are no numbers, or a turn that is none; the bones "
        "cannot be placed there");
  return poses;
}

BodyPoses ContactModel::State::as_poses(const std::vector<Pose>& X_CB) const {
  return {X_CB[mandible_body], {X_CB.begin() + first_free_body, X_CB.end()}};
}

std::vector<bool> ContactModel::State::far_pairs(const std::vector<Pose>& X_CB) const {
  std::vector<bool> far(count(), false);
  if (!broadphase) return far;
  std::vector<Pose> poses;
  for (const auto& collider : colliders)
    poses.push_back(X_CB[static_cast<std::size_t>(collider->body)]);
  const std::vector<BodyPair> near = broadphase->near(poses, settings.far_mm);
  for (std::size_t i = 0; i < far.size(); ++i) {
    const ColliderPair& pair = judged(i);
    const BodyPair sought{std::min(pair.a->number, pair.b->number),
                          std::max(pair.a->number, pair.b->number)};
    far[i] =
        pair.b->body >= first_free_body && !std::binary_search(near.begin(), near.end(), sought);
  }
  return far;
}

ContactSet ContactModel::State::judge_all(const std::vector<Pose>& X_CB, const ContactSet* previous,
                                          int threads) const {
  ContactSet set;
  set.X_CM = X_CB[mandible_body];
  set.X_CF.assign(X_CB.begin() + first_free_body, X_CB.end());
  set.pairs.resize(pairs.size());
  set.away_from_rest.resize(guards.size());
  const std::vector<bool> far = far_pairs(X_CB);
  parallel_for(count(), threads, [&](std::size_t i) {
    const ColliderPair& pair = judged(i);
    if (far[i])
      slot(set, i) = far_apart(pair, settings.far_mm);
    else
      slot(set, i) =
          judge(pair, X_CB[static_cast<std::size_t>(pair.a->body)],
                X_CB[static_cast<std::size_t>(pair.b->body)], start(previous, i), full_look(i));
  });
  return set;
}

void ContactModel::State::measure_bounds(const std::vector<Pose>& X_CB, ContactSet& set) const {
  for (std::size_t i = 0; i < count(); ++i) {
    PairContact& found = slot(set, i);
    if (!found.distance_is_bound || found.distance_mm >= full_look(i).far_mm) continue;
    const ColliderPair& pair = judged(i);
    found = judge(pair, X_CB[static_cast<std::size_t>(pair.a->body)],
                  X_CB[static_cast<std::size_t>(pair.b->body)],
                  {found.triangle_a, found.triangle_b}, full_look(i));
  }
}

ContactSet ContactModel::State::with_guards(ContactSet set) const {
  for (std::size_t g = 0; g < guards.size(); ++g) {
    if (!set.away_from_rest[g].touching) continue;
    PairContact& pair = set.pairs[guarded[g]];
    pair.depth_mm = std::max(pair.depth_mm, pair.rest_depth_mm + set.away_from_rest[g].depth_mm);
  }
  return set;
}

ContactModel::ContactModel(const Case& patient, const ContactSettings& settings)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.settings = settings;
  check_rules(patient, patient.pair_rules, "the case's rule for");
  check_rules(patient, settings.pair_rules, "the rule for");
  for (const std::size_t i : free_parts(patient.parts))
    state.carrier.push_back(patient.parts[i].carrier);
  build_colliders(state, patient);
  for (const auto& collider : state.colliders)
    if (const Solid& solid = collider->solid; solid.open_shell_count() > 0)
      state.notes.push_back(fmt::format(
          "{}: {} of {} pieces are open surfaces without an inside; their depth of overlap is "
          "judged from the crossing triangles alone",
          patient.parts[static_cast<std::size_t>(collider->part)].name, solid.open_shell_count(),
          solid.shell_count()));
  build_pairs(state, patient);
  find_baseline(state, patient);
  state.slider = std::make_unique<Slider>(patient, state);
}

ContactModel::~ContactModel() = default;
ContactModel::ContactModel(ContactModel&&) noexcept = default;

ContactSet ContactModel::find(const BodyPoses& at, const ContactSet* previous, int threads) const {
  return state_->with_guards(state_->judge_all(state_->body_poses(at), previous, threads));
}

namespace {

/// Whether the set was taken at these poses, with no guard's finding counted into its depths.
bool taken_at(const ContactModel::State& state, const ContactSet* set,
              const std::vector<Pose>& X_CB) {
  if (!state.fits(set) || set->X_CF.size() != state.carrier.size() ||
      !same_bits(set->X_CM, X_CB[mandible_body]))
    return false;
  for (const auto& guard : set->away_from_rest)
    if (guard.touching) return false;
  for (std::size_t f = 0; f < set->X_CF.size(); ++f)
    if (!same_bits(set->X_CF[f], X_CB[first_free_body + f])) return false;
  return true;
}

}  // namespace

ContactModel::Stop ContactModel::stop_at_contact(const Pose& from, const Pose& wanted,
                                                 const ContactSet* previous, int threads) const {
  const State& state = *state_;
  state.body_poses(wanted);  // refuses what is not finite
  const std::vector<Pose> X_CB = state.body_poses(from);
  // An answer from elsewhere still tells where the queries start.
  const bool known = taken_at(state, previous, X_CB);
  const bool near = state.carrier.empty() && state.fits(previous);
  ContactSet set = known || near ? *previous : state.judge_all(X_CB, previous, threads);
  const bool exact = known || !near;
  const Drive drive = make_drive(state, X_CB, mandible_body, wanted);
  const Arrival arrival = stop(state, drive, set, exact, threads);
  const BodyPoses there = state.as_poses(drive.poses_at(arrival.X_CD));
  set.X_CM = there.X_CM;
  set.X_CF = there.X_CF;
  return {arrival.X_CD, arrival.stopped, state.with_guards(std::move(set))};
}

BodyPoses ContactModel::placed(const Wanted& wanted) const {
  BodyPoses at(wanted.X_CM);
  for (std::size_t f = 0; f < state_->carrier.size(); ++f) {
    const Pose X_CB = state_->carrier[f] == Body::mandible ? wanted.X_CM : Pose{};
    const bool asked = f < wanted.X_BF.size() && !same_bits(wanted.X_BF[f], {});
    at.X_CF.push_back(asked ? X_CB * wanted.X_BF[f] : X_CB);
  }
  return at;
}

void ContactModel::prepare_sliding(const Progress& progress, int threads) const {
  state_->slider->prepare(progress, threads);
}

ContactModel::Slide ContactModel::slide(const BodyPoses& from, const Wanted& wanted,
                                        const ContactSet* previous, int threads,
                                        bool bound_far) const {
  const State& state = *state_;
  std::vector<Pose> X_CB = state.body_poses(from);
  state.body_poses({wanted.X_CM, wanted.X_BF});  // refuses what is no pose
  bool exact = taken_at(state, previous, X_CB);
  const bool near = state.carrier.empty() && state.fits(previous);
  ContactSet set = exact || near ? *previous : state.judge_all(X_CB, previous, threads);
  exact = exact || !near;
  Slide result;
  const auto go = [&](int body, const Pose& to) {
    const Drive drive = make_drive(state, X_CB, body, to);
    const Arrival arrival = slide_drive(state, drive, set, exact, bound_far, threads);
    X_CB = drive.poses_at(arrival.X_CD);
    exact = true;
    result.stopped |= arrival.stopped;
  };
  go(mandible_body, wanted.X_CM);
  const BodyPoses target = placed({X_CB[mandible_body], wanted.X_BF});
  for (std::size_t f = 0; f < state.carrier.size(); ++f) {
    const Pose& to = target.X_CF[f];
    const int body = first_free_body + static_cast<int>(f);
    if (!same_bits(X_CB[static_cast<std::size_t>(body)], to)) go(body, to);
  }
  if (!bound_far) state.measure_bounds(X_CB, set);
  result.at = state.as_poses(X_CB);
  set.X_CM = result.at.X_CM;
  set.X_CF = result.at.X_CF;
  result.contacts = state.with_guards(std::move(set));
  return result;
}

const ContactSet& ContactModel::at_rest() const { return state_->rest; }
const std::vector<PairRule>& ContactModel::rules() const { return state_->rules; }
const std::vector<std::string>& ContactModel::notes() const { return state_->notes; }

}  // namespace condyle
