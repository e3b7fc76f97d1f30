#include "sim/contact/slider.h"

#include <algorithm>

#include "engine/core/user_cache.h"
#include "sim/contact/sliding_settings.h"

namespace condyle {
namespace {

using Resolution = SlidingResolution;

constexpr double reach_mm = 20;  // of the other bodies beyond their boxes at rest
constexpr double band_mm = 1;
// For guided pairs: fields reach little farther than twice the gap. Larger gaps are kept by exact
// distances alone.
constexpr double widest_gap_mm = 4;
// Between samples along a path, for points as far from the centre as those of a jaw.
constexpr double coverage_step_mm = 5, turning_mm = 80;
constexpr double exit_distances_mm[] = {4, 8, 16};
constexpr std::size_t max_settings = 24;

double spacing_of(const BodyTree& bodies, const Part& part) {
  if (is_teeth(part.role)) return Resolution::tooth_spacing_mm;
  if (bodies.roams(part.body)) return Resolution::roaming_spacing_mm;
  return part.body == cranium_body ? Resolution::cranium_spacing_mm : Resolution::jaw_spacing_mm;
}

}  // namespace

Slider::Slider(const Case& patient, const ContactModel::State& state, Slider* earlier)
    : state_(state) {
  std::vector<Box> boxes(state.bodies.bodies().size());
  for (const auto& collider : state.colliders)
    boxes[index_of(collider->body)].add(collider->surface.box());
  for (const auto& collider : state.colliders) {
    if (collider->complement) continue;
    const Part& part = patient.parts[static_cast<std::size_t>(collider->part)];
    Surface surface{collider->number, part.mesh, {}, nullptr, {}};
    FieldSettings& field = surface.settings.field;
    field.spacing_mm = spacing_of(state.bodies, part);
    field.band_mm = band_mm;
    for (const auto& pair : state.pairs)
      if ((pair.a == collider.get() || pair.b == collider.get()) &&
          pair.min_distance_mm <= widest_gap_mm)
        field.band_mm = std::max(field.band_mm, 2 * pair.min_distance_mm + 0.5 * band_mm);
    if (!state.bodies.roams(collider->body)) {  // a roaming body may be anywhere, and is small
      field.region.emplace();
      for (std::size_t body = 0; body < boxes.size(); ++body)
        if (body != index_of(collider->body)) field.region->add(boxes[body]);
      // No other body is near: a minimal field that will not be queried.
      if (field.region->empty()) field.region->add(collider->surface.box().low);
      field.region->low.array() -= reach_mm;
      field.region->high.array() += reach_mm;
    }
    surface.settings.samples.spacing_mm =
        is_teeth(part.role) ? Resolution::tooth_sample_mm : Resolution::bone_sample_mm;
    surface.settings.cache = user_cache_folder();
    surface.coverage = field_coverage(collider->surface.box(), field.region);
    surfaces_.push_back(std::move(surface));
  }
  if (earlier) take_over(*earlier);
}

void Slider::take_over(Slider& earlier) {
  const std::lock_guard lock(earlier.mutex_);
  const auto shape = [](const Slider& slider, const Surface& surface) {
    return slider.state_.colliders[static_cast<std::size_t>(surface.collider)]->shape.get();
  };
  const auto same_field = [](const FieldSettings& a, const FieldSettings& b) {
    return a.spacing_mm == b.spacing_mm && a.band_mm == b.band_mm &&
           a.region.has_value() == b.region.has_value() &&
           (!a.region || (a.region->low == b.region->low && a.region->high == b.region->high));
  };
  for (Surface& surface : surfaces_)
    for (const Surface& other : earlier.surfaces_) {
      if (!other.body || shape(*this, surface) != shape(earlier, other) ||
          !same_field(surface.settings.field, other.settings.field) ||
          surface.settings.samples.spacing_mm != other.settings.samples.spacing_mm)
        continue;
      surface.body = other.body;
      surface.coverage.thin = other.coverage.thin;
      surface.mesh = {};
    }
}

void Slider::prepare(const Progress& progress, int threads) {
  const std::lock_guard lock(mutex_);
  if (ready_) return;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    report(progress, "making the bones ready to slide",
           static_cast<double>(i) / static_cast<double>(surfaces_.size()));
    Surface& surface = surfaces_[i];
    if (surface.body) continue;
    surface.body = std::make_shared<const ContactSurface>(make_contact_surface(
        surface.mesh, surface.settings, threads, [&](std::string_view, double fraction) {
          report(progress, "making the bones ready to slide",
                 (static_cast<double>(i) + fraction) / static_cast<double>(surfaces_.size()));
        }));
    surface.mesh = {};
    surface.coverage.thin = is_thin(*surface.body);
  }
  contacts_.resize(state_.bodies.bodies().size());
  outside_.resize(contacts_.size());
  for (int body = 1; body < state_.bodies.size(); ++body) {
    contacts_[static_cast<std::size_t>(body)] = make_contact(BodyId{body});
    outside_[static_cast<std::size_t>(body)] = find_outside(BodyId{body});
  }
  report(progress, "making the bones ready to slide", 1);
  ready_ = true;
}

std::unique_ptr<SlidingContact> Slider::make_contact(BodyId body) const {
  const BodyMove move = make_move(state_, completed(state_.bodies, {}), body, {});
  std::vector<std::shared_ptr<const ContactSurface>> fixed, moving;
  std::vector<int> place(state_.colliders.size(), -1);
  for (const Surface& surface : surfaces_) {
    const auto number = static_cast<std::size_t>(surface.collider);
    auto& side = move.moves[index_of(state_.colliders[number]->body)] ? moving : fixed;
    place[number] = static_cast<int>(side.size());
    side.push_back(surface.body);
  }
  std::vector<SlidePair> pairs;
  for (const auto& pair : state_.pairs) {
    if (!move.obstructed_by(pair) || pair.min_distance_mm > widest_gap_mm) continue;
    int a = place[static_cast<std::size_t>(pair.a->number)],
        b = place[static_cast<std::size_t>(pair.b->number)];
    if (move.moves[index_of(pair.a->body)]) std::swap(a, b);
    const auto closed = [](const Collider& one) { return one.solid.open_shell_count() == 0; };
    pairs.push_back(
        {a, b, pair.min_distance_mm, pair.apart_at_rest && closed(*pair.a) && closed(*pair.b)});
  }
  auto contact = std::make_unique<SlidingContact>(
      std::move(fixed), std::move(moving), pairs,
      SlideSettings{
          .friction = state_.settings.friction, .slop_mm = Resolution::slop_mm, .pivot = {}});
  contact->allow_overlap_at({}, Resolution::fade_mm);
  return contact;
}

std::optional<Pose> Slider::find_outside(BodyId body) const {
  const BodyMove move = make_move(state_, completed(state_.bodies, {}), body, {});
  Eigen::Vector3d out = Eigen::Vector3d::Zero();  // sum of the exit directions
  for (std::size_t i = 0; i < state_.pairs.size(); ++i) {
    const ColliderPair& pair = state_.pairs[i];
    if (!move.obstructed_by(pair) || pair.rest_depth_mm <= deep_mm) continue;
    const double sign = move.moves[index_of(pair.a->body)] ? -1 : 1;
    for (const ContactPoint& contact : state_.rest.pairs[i].contacts) out += sign * contact.normal;
  }
  if (!(out.norm() > 0)) return std::nullopt;
  for (const double distance_mm : exit_distances_mm) {
    const Pose X{Eigen::Quaterniond::Identity(), distance_mm * out.normalized()};
    if (contact(body).depth(X) == 0) return X;
  }
  return std::nullopt;
}

std::optional<Pose> Slider::outside(const BodyMove& move) const {
  for (std::size_t b = 0; b < move.at.X_CB.size(); ++b)
    if (move.moves[b] ? move.X_DM[b].has_value() : !bit_identical(move.at.X_CB[b], {}))
      return std::nullopt;
  return outside_[index_of(move.body)];
}

bool Slider::covers(const BodyMove& move) const {
  std::vector<const FieldCoverage*> of(state_.colliders.size(), nullptr);
  for (const Surface& surface : surfaces_)
    of[static_cast<std::size_t>(surface.collider)] = &surface.coverage;
  const double path_mm = (move.target.t - move.from().t).norm() +
                         rotation_angle(move.from().inverse() * move.target) * turning_mm;
  const int steps = 1 + static_cast<int>(path_mm / coverage_step_mm);
  std::vector<BodyPoses> at;
  for (int i = 0; i <= steps; ++i)
    at.push_back(move.poses_at(
        interpolate(move.from(), move.target, static_cast<double>(i) / steps, pivot(move.body))));
  return std::none_of(state_.pairs.begin(), state_.pairs.end(), [&](const ColliderPair& pair) {
    if (!move.obstructed_by(pair)) return false;
    const FieldCoverage &a = *of[static_cast<std::size_t>(pair.a->number)],
                        &b = *of[static_cast<std::size_t>(pair.b->number)];
    if ((a.thin && b.thin) || pair.min_distance_mm > widest_gap_mm) return true;
    // A jaw does not leave its joints far enough to bring other parts to the outside regions.
    if (state_.in_joint(pair)) return a.uncovered || b.uncovered;
    return std::any_of(at.begin(), at.end(), [&](const BodyPoses& X) {
      const Pose X_AB = X[pair.a->body].inverse() * X[pair.b->body];
      const auto meets = [&](const Box& box_a, const Box& box_b) {
        return boxes_meet(box_a, box_b, X_AB, 0.5 * coverage_step_mm + pair.min_distance_mm);
      };
      return std::any_of(a.outside.begin(), a.outside.end(),
                         [&](const Box& box) { return meets(box, b.box); }) ||
             std::any_of(b.outside.begin(), b.outside.end(),
                         [&](const Box& box) { return meets(a.box, box); });
    });
  });
}

std::unique_ptr<Slider::Setting> Slider::take_setting(const BodyMove& move) const {
  std::vector<Pose> X_FS, X_MS;
  for (const Surface& surface : surfaces_) {
    const BodyId body = state_.colliders[static_cast<std::size_t>(surface.collider)]->body;
    if (!move.moves[index_of(body)])
      X_FS.push_back(move.at[body]);
    else
      X_MS.push_back(move.X_DM[index_of(body)].value_or(Pose{}));
  }
  const auto alike = [](const std::vector<Pose>& x, const std::vector<Pose>& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), bit_identical);
  };
  std::unique_ptr<Setting> setting;
  {
    const std::lock_guard lock(settings_mutex_);
    auto best = settings_.end();
    for (auto it = settings_.begin(); it != settings_.end(); ++it)
      if ((*it)->body == move.body) {
        best = it;
        if (alike((*it)->X_FS, X_FS) && alike((*it)->X_MS, X_MS)) break;
      }
    if (best != settings_.end()) {
      setting = std::move(*best);
      settings_.erase(best);
    }
  }
  if (!setting)
    setting = std::make_unique<Setting>(Setting{move.body, {}, {}, contact(move.body), {}});
  if (!alike(setting->X_FS, X_FS) || !alike(setting->X_MS, X_MS)) {
    setting->contact.place(X_FS, X_MS);
    setting->X_FS = std::move(X_FS);
    setting->X_MS = std::move(X_MS);
  }
  return setting;
}

void Slider::keep_setting(std::unique_ptr<Setting> setting) const {
  const std::lock_guard lock(settings_mutex_);
  settings_.push_back(std::move(setting));
  if (settings_.size() > max_settings) settings_.erase(settings_.begin());
}

bool Slider::surely_crosses(const BodyMove& move, int threads) const {
  if (!ready_) return false;
  auto setting = take_setting(move);
  const bool crosses = setting->contact.surely_overlaps(move.target, setting->memory, threads);
  keep_setting(std::move(setting));
  return crosses;
}

SlideResult Slider::slide(const BodyMove& move, const Pose& from, const Pose& target,
                          int threads) const {
  auto setting = take_setting(move);
  SlideResult result = setting->contact.slide(from, target, &setting->memory, threads);
  keep_setting(std::move(setting));
  return result;
}

}  // namespace condyle
