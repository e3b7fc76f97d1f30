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
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  // middle of the mandible, its coordinates
  ContactSet rest;
  std::vector<std::string> notes;

  TrianglePair start(const ContactSet* previous, std::size_t pair) const {
    if (!previous || previous->pairs.size() != pairs.size()) return {};
    return {previous->pairs[pair].triangle_a, previous->pairs[pair].triangle_b};
  }
};

ContactModel::ContactModel(const Case& patient, const ContactSettings& settings)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.settings = settings;
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const Part& part = patient.parts[i];
    if (!collides(part.role) || part.mesh.empty()) continue;
    state.colliders.push_back(std::make_unique<Collider>(
        Collider{static_cast<int>(i), CollisionMesh(part.mesh), Solid(part.mesh)}));
    const Solid& solid = state.colliders.back()->solid;
    if (solid.open_shell_count() > 0)
      state.notes.push_back(
          fmt::format("{}: {} of {} pieces are open surfaces without an inside; their depth of "
                      "overlap is judged "
                      "from the crossing triangles alone",
                      part.name, solid.open_shell_count(), solid.shell_count()));
  }
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

  state.rest = find(Pose{}, nullptr);
  for (std::size_t i = 0; i < state.pairs.size(); ++i) {
    PairContact& rest = state.rest.pairs[i];
    state.pairs[i].apart_at_rest = !rest.touching;
    state.pairs[i].rest_depth_mm = rest.rest_depth_mm = rest.depth_mm;
    if (rest.touching)
      state.notes.push_back(fmt::format(
          "{} and {} overlap by {:.2f} mm at rest: taken as the baseline, only deeper contact "
          "counts",
          patient.parts[rest.part_a].name, patient.parts[rest.part_b].name, rest.depth_mm));
  }
}

ContactModel::~ContactModel() = default;
ContactModel::ContactModel(ContactModel&&) noexcept = default;

ContactSet ContactModel::find(const Pose& X_CM, const ContactSet* previous, int threads) const {
  ContactSet set;
  set.X_CM = X_CM;
  set.pairs.resize(state_->pairs.size());
  parallel_for(set.pairs.size(), threads, [&](std::size_t i) {
    set.pairs[i] =
        judge(state_->pairs[i], X_CM, state_->start(previous, i), state_->settings.max_contacts);
  });
  return set;
}

ContactModel::Stop ContactModel::stop_at_contact(const Pose& from, const Pose& wanted,
                                                 const ContactSet* previous, int threads) const {
  const State& state = *state_;
  const ContactSettings& settings = state.settings;
  Stop stop{wanted, false, find(wanted, previous, threads)};
  if (same_bits(from, wanted)) return stop;

  const bool previous_is_from =
      previous && previous->pairs.size() == state.pairs.size() && same_bits(previous->X_CM, from);
  const double shift_mm = (wanted * state.pivot - from * state.pivot).norm();
  const double angle = rotation_angle(from.inverse() * wanted);
  std::vector<double> reached(state.pairs.size(), 1.0);
  parallel_for(state.pairs.size(), threads, [&](std::size_t i) {
    const ColliderPair& pair = state.pairs[i];
    const Solid& moving = pair.b->solid;
    Way way{from, wanted, state.pivot,
            shift_mm + angle * ((moving.center() - state.pivot).norm() + moving.radius())};
    Margin margin{pair, pair.apart_at_rest ? -1.0 : pair.rest_depth_mm + settings.slack_mm};
    const double margin_wanted = margin.of(stop.contacts.pairs[i]);
    if (margin_wanted > way.length_mm) return;  // nothing within reach of the whole way
    if (way.length_mm < 1e-12) {
      if (margin_wanted < 0) reached[i] = 0;
      return;
    }
    const PairContact start = previous_is_from
                                  ? previous->pairs[i]
                                  : judge(pair, from, state.start(&stop.contacts, i), 0);
    // A start that is already too deep may leave, but go no deeper.
    if (start.touching) margin.limit_mm = std::max(margin.limit_mm, start.depth_mm);
    FreeWay free(margin, way, 0.5 * settings.stop_gap_mm, {start.triangle_a, start.triangle_b});
    reached[i] = free.advance(0, margin.of(start), 1, margin.of(stop.contacts.pairs[i]));
  });
  const double s = reached.empty() ? 1.0 : *std::min_element(reached.begin(), reached.end());
  if (s >= 1) return stop;
  const Pose X_CM = interpolate(from, wanted, s, state.pivot);
  return {X_CM, true, find(X_CM, &stop.contacts, threads)};
}

const ContactSet& ContactModel::at_rest() const { return state_->rest; }
const std::vector<std::string>& ContactModel::notes() const { return state_->notes; }

}  // namespace condyle
