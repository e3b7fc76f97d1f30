#include "sim/contact/contact.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/solid.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

// Crossing triangles looked at: all (arches in full bite have some thousands) where the depth is
// judged from them, else a few from each part of the surface.
constexpr ContactLimits all_crossings{.total = 8192, .per_region = 8192};
constexpr ContactLimits some_crossings{.total = 1024, .per_region = 8};
// Ways shorter than this are judged by their ends alone. A tenth of a millimetre is a third of the
// thinnest wall met in real anatomy (0.3 mm), so nothing is passed through unseen.
constexpr double proof_step_mm = 0.1;
// Overlap at rest is excused in its neighbourhood only: teeth that are modelled a millimetre into
// each other must not excuse a condyle from its fossa.
constexpr double excused_mm = 10;
constexpr int build_threads = 2;

/// One surface that takes part, and the pose-independent queries on it.
struct Collider {
  int part = 0;  // index in the case
  CollisionMesh surface;
  Solid solid;
};

struct ColliderPair {
  const Collider* a = nullptr;  // cranium
  const Collider* b = nullptr;  // mandible
  bool apart_at_rest = true;
  double rest_depth_mm = 0;
};

/// `count` of the contacts, spread evenly over their order.
std::vector<ContactPoint> thin(const std::vector<MeshContact>& all, int count) {
  std::vector<ContactPoint> kept;
  const std::size_t wanted = std::min(all.size(), static_cast<std::size_t>(std::max(count, 0)));
  kept.reserve(wanted);
  for (std::size_t i = 0; i < wanted; ++i) {
    const MeshContact& contact = all[i * all.size() / wanted];
    kept.push_back({contact.point, contact.normal});
  }
  return kept;
}

/// Everything about one pair at one pose.
PairContact judge(const ColliderPair& pair, const Pose& X_CM, TrianglePair start,
                  int max_contacts) {
  const Pose X_CC;  // the cranium is the world
  const Collider &a = *pair.a, &b = *pair.b;
  PairContact out;
  out.part_a = a.part;
  out.part_b = b.part;
  out.rest_depth_mm = pair.rest_depth_mm;
  const MeshDistance nearest = distance(a.surface, X_CC, b.surface, X_CM, start);
  out.distance_mm = nearest.distance_mm;
  out.witness_a = nearest.witness_a;
  out.witness_b = nearest.witness_b;
  out.triangle_a = nearest.triangles.a;
  out.triangle_b = nearest.triangles.b;
  const bool crossing = nearest.distance_mm == 0;
  if (!crossing && !one_encloses_other(a.solid, X_CC, b.solid, X_CM)) return out;

  out.touching = true;
  out.distance_mm = 0;
  const OverlapDepth deepest = overlap_depth(a.solid, X_CC, b.solid, X_CM);
  out.depth_mm = deepest.depth_mm;
  if (!crossing) {
    out.contacts.push_back({deepest.point, deepest.normal});
    return out;
  }
  // Open shells have no inside, and edges may cross without a corner inside: then the depth is the
  // largest move that parts one pair of crossing triangles (bounded by their size).
  const bool by_triangles =
      out.depth_mm == 0 || a.solid.open_shell_count() > 0 || b.solid.open_shell_count() > 0;
  if (!by_triangles && max_contacts == 0) return out;
  const auto all =
      contacts(a.surface, X_CC, b.surface, X_CM, by_triangles ? all_crossings : some_crossings);
  out.contacts = thin(all, max_contacts);
  if (all.empty() && max_contacts > 0)  // they touch in a point
    out.contacts.push_back({nearest.witness_a, deepest.normal});
  if (by_triangles)
    for (const auto& contact : all)
      out.depth_mm =
          std::max(out.depth_mm, overlap(a.surface, X_CC, b.surface, X_CM, contact.triangles));
  return out;
}

/// The triangles of B that neither cross A at rest nor come within excused_mm of a place that does.
TriMesh away_from_overlap(const TriMesh& mesh, const std::vector<MeshContact>& overlap_at_rest) {
  std::vector<bool> excused(mesh.triangles.size(), false);
  std::vector<bool> near(mesh.vertices.size(), false);
  for (const auto& contact : overlap_at_rest)
    excused[static_cast<std::size_t>(contact.triangles.b)] = true;
  for (std::size_t v = 0; v < near.size(); ++v)
    near[v] = std::any_of(overlap_at_rest.begin(), overlap_at_rest.end(), [&](const auto& contact) {
      return (contact.point - mesh.vertices[v]).squaredNorm() < excused_mm * excused_mm;
    });
  TriMesh away{mesh.vertices, {}, {}};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    if (!excused[i] && !near[t[0]] && !near[t[1]] && !near[t[2]]) away.triangles.push_back(t);
  }
  return away;
}

/// The way of one part of the mandible from a pose to another, as s goes from 0 to 1.
struct Way {
  Pose from, to;
  Eigen::Vector3d pivot;
  double length_mm = 0;  // no point of the part moves farther

  Pose at(double s) const { return interpolate(from, to, s, pivot); }
};

/// How far a pair may still come nearer, or deeper, before it is blocked: changes by at most a
/// millimetre per millimetre of motion. Negative: blocked.
struct Margin {
  const ColliderPair& pair;
  double limit_mm;  // depth allowed; negative: may not touch at all

  double of(const PairContact& contact) const {
    if (!contact.touching) return contact.distance_mm + std::max(limit_mm, 0.0);
    return limit_mm < 0 ? -1.0 : limit_mm - contact.depth_mm;
  }
};

/// Largest s in [a, b] up to which the way is known to be free; a is free.
class FreeWay {
 public:
  FreeWay(const Margin& margin, const Way& way, double precision_mm, TrianglePair start)
      : margin_(margin), way_(way), precision_mm_(precision_mm), start_(start) {}

  double advance(double a, double margin_a, double b, double margin_b) {
    // Free from a to low and from high to b, because margins change by at most the motion.
    const double low = a + margin_a / way_.length_mm;
    const double high = b - std::max(margin_b, 0.0) / way_.length_mm;
    const bool b_is_free = margin_b >= 0;
    if (b_is_free && low > high) return b;
    if ((high - low) * way_.length_mm <= proof_step_mm) {
      if (b_is_free) return b;
      return bisect(a, margin_a, b);
    }
    const double middle = 0.5 * (low + high);
    const double margin_middle = margin_at(middle);
    const double reached = advance(a, margin_a, middle, margin_middle);
    if (margin_middle < 0 || reached < middle) return reached;
    return advance(middle, margin_middle, b, margin_b);
  }

 private:
  double margin_at(double s) {
    const PairContact contact = judge(margin_.pair, way_.at(s), start_, 0);
    start_ = {contact.triangle_a, contact.triangle_b};
    return margin_.of(contact);
  }

  /// a is free, b is not.
  double bisect(double a, double margin_a, double b) {
    a = std::min(a + 0.999 * margin_a / way_.length_mm, b);
    while ((b - a) * way_.length_mm > precision_mm_) {
      const double middle = 0.5 * (a + b);
      (margin_at(middle) >= 0 ? a : b) = middle;
    }
    return a;
  }

  Margin margin_;
  const Way& way_;
  double precision_mm_;
  TrianglePair start_;
};

bool same_bits(const Pose& x, const Pose& y) { return x.R.coeffs() == y.R.coeffs() && x.t == y.t; }

}  // namespace

struct ContactModel::State {
  ContactSettings settings;
  std::vector<std::unique_ptr<Collider>> colliders;
  std::vector<ColliderPair> pairs;
  std::vector<ColliderPair> guards;                 // see ContactSet::away_from_rest
  std::vector<std::size_t> guarded;                 // the pair of each guard
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  // middle of the mandible, its coordinates
  ContactSet rest;
  std::vector<std::string> notes;

  /// Pairs, then guards, under one number.
  std::size_t count() const { return pairs.size() + guards.size(); }
  const ColliderPair& judged(std::size_t i) const {
    return i < pairs.size() ? pairs[i] : guards[i - pairs.size()];
  }
  PairContact& slot(ContactSet& set, std::size_t i) const {
    return i < pairs.size() ? set.pairs[i] : set.away_from_rest[i - pairs.size()];
  }
  const PairContact& slot(const ContactSet& set, std::size_t i) const {
    return i < pairs.size() ? set.pairs[i] : set.away_from_rest[i - pairs.size()];
  }
  bool fits(const ContactSet* set) const {
    return set && set->pairs.size() == pairs.size() && set->away_from_rest.size() == guards.size();
  }
  TrianglePair start(const ContactSet* previous, std::size_t i) const {
    if (!fits(previous)) return {};
    return {slot(*previous, i).triangle_a, slot(*previous, i).triangle_b};
  }

  ContactSet judge_all(const Pose& X_CM, const ContactSet* previous, int threads) const {
    ContactSet set;
    set.X_CM = X_CM;
    set.pairs.resize(pairs.size());
    set.away_from_rest.resize(guards.size());
    parallel_for(count(), threads, [&](std::size_t i) {
      slot(set, i) =
          judge(judged(i), X_CM, start(previous, i), i < pairs.size() ? settings.max_contacts : 0);
    });
    return set;
  }

  /// Counts what the guards found into the depths of their pairs.
  ContactSet with_guards(ContactSet set) const {
    for (std::size_t g = 0; g < guards.size(); ++g) {
      if (!set.away_from_rest[g].touching) continue;
      PairContact& pair = set.pairs[guarded[g]];
      pair.depth_mm = std::max(pair.depth_mm, pair.rest_depth_mm + set.away_from_rest[g].depth_mm);
    }
    return set;
  }
};

ContactModel::ContactModel(const Case& patient, const ContactSettings& settings)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.settings = settings;
  std::vector<int> parts;
  for (std::size_t i = 0; i < patient.parts.size(); ++i)
    if (collides(patient.parts[i].role) && !patient.parts[i].mesh.empty())
      parts.push_back(static_cast<int>(i));
  state.colliders.resize(parts.size());
  parallel_for(parts.size(), build_threads, [&](std::size_t i) {
    const TriMesh& mesh = patient.parts[parts[i]].mesh;
    state.colliders[i] =
        std::make_unique<Collider>(Collider{parts[i], CollisionMesh(mesh), Solid(mesh)});
  });
  for (const auto& collider : state.colliders)
    if (const Solid& solid = collider->solid; solid.open_shell_count() > 0)
      state.notes.push_back(fmt::format(
          "{}: {} of {} pieces are open surfaces without an inside; their depth of overlap is "
          "judged "
          "from the crossing triangles alone",
          patient.parts[collider->part].name, solid.open_shell_count(), solid.shell_count()));
  double largest = -1;
  for (const auto& b : state.colliders) {
    if (body_of(patient.parts[b->part].role) != Body::mandible) continue;
    if (b->solid.radius() > largest) {
      largest = b->solid.radius();
      state.pivot = b->solid.center();
    }
  }
  for (const auto& a : state.colliders)
    for (const auto& b : state.colliders)
      if (body_of(patient.parts[a->part].role) == Body::cranium &&
          body_of(patient.parts[b->part].role) == Body::mandible)
        state.pairs.push_back({a.get(), b.get(), true, 0});

  state.rest = state.judge_all(Pose{}, nullptr, 1);
  for (std::size_t i = 0; i < state.pairs.size(); ++i) {
    ColliderPair& pair = state.pairs[i];
    PairContact& rest = state.rest.pairs[i];
    pair.apart_at_rest = !rest.touching;
    pair.rest_depth_mm = rest.rest_depth_mm = rest.depth_mm;
    if (!rest.touching) continue;
    state.notes.push_back(fmt::format(
        "{} and {} overlap by {:.2f} mm at rest: taken as the baseline, only deeper contact counts",
        patient.parts[rest.part_a].name, patient.parts[rest.part_b].name, rest.depth_mm));
    const TriMesh away =
        away_from_overlap(patient.parts[rest.part_b].mesh,
                          contacts(pair.a->surface, {}, pair.b->surface, {}, all_crossings));
    if (away.empty()) continue;
    state.colliders.push_back(
        std::make_unique<Collider>(Collider{rest.part_b, CollisionMesh(away), Solid(away)}));
    const ColliderPair guard{pair.a, state.colliders.back().get(), true, 0};
    if (judge(guard, {}, {}, 0).touching) continue;  // wholly inside at rest: nothing to guard
    state.guards.push_back(guard);
    state.guarded.push_back(i);
  }
  state.rest = state.judge_all(Pose{}, &state.rest, 1);
}

ContactModel::~ContactModel() = default;
ContactModel::ContactModel(ContactModel&&) noexcept = default;

ContactSet ContactModel::find(const BodyPoses& at, const ContactSet* previous, int threads) const {
  return state_->with_guards(state_->judge_all(at.X_CM, previous, threads));
}

ContactModel::Stop ContactModel::stop_at_contact(const Pose& from, const Pose& wanted,
                                                 const ContactSet* previous, int threads) const {
  const State& state = *state_;
  const ContactSettings& settings = state.settings;
  ContactSet at_wanted = state.judge_all(wanted, previous, threads);
  if (same_bits(from, wanted)) return {wanted, false, state.with_guards(std::move(at_wanted))};

  const bool previous_is_from = state.fits(previous) && same_bits(previous->X_CM, from);
  const double shift_mm = (wanted * state.pivot - from * state.pivot).norm();
  const double angle = rotation_angle(from.inverse() * wanted);
  std::vector<double> reached(state.count(), 1.0);
  parallel_for(reached.size(), threads, [&](std::size_t i) {
    const ColliderPair& pair = state.judged(i);
    const Solid& moving = pair.b->solid;
    const Way way{from, wanted, state.pivot,
                  shift_mm + angle * ((moving.center() - state.pivot).norm() + moving.radius())};
    Margin margin{pair, pair.apart_at_rest ? -1.0 : pair.rest_depth_mm + settings.slack_mm};
    const PairContact& end = state.slot(at_wanted, i);
    if (margin.of(end) > way.length_mm) return;  // nothing within reach of the whole way
    if (way.length_mm < 1e-12) {
      if (margin.of(end) < 0) reached[i] = 0;
      return;
    }
    // An earlier answer serves for the start, unless a guard has been counted into its depth.
    const PairContact start = previous_is_from && previous->max_penetration_mm() <= 0
                                  ? state.slot(*previous, i)
                                  : judge(pair, from, {end.triangle_a, end.triangle_b}, 0);
    // A start that is already too deep may leave, but go no deeper.
    if (start.touching) margin.limit_mm = std::max(margin.limit_mm, start.depth_mm);
    FreeWay free(margin, way, 0.5 * settings.stop_gap_mm, {start.triangle_a, start.triangle_b});
    reached[i] = free.advance(0, margin.of(start), 1, margin.of(end));
  });
  const double s = reached.empty() ? 1.0 : *std::min_element(reached.begin(), reached.end());
  if (s >= 1) return {wanted, false, state.with_guards(std::move(at_wanted))};
  const Pose X_CM = interpolate(from, wanted, s, state.pivot);
  return {X_CM, true, find(X_CM, &at_wanted, threads)};
}

const ContactSet& ContactModel::at_rest() const { return state_->rest; }
const std::vector<std::string>& ContactModel::notes() const { return state_->notes; }

}  // namespace condyle
