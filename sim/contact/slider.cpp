#include "sim/contact/slider.h"

#include <algorithm>

namespace condyle {
namespace {

constexpr double reach_mm = 20;  // of the other bodies beyond their boxes at rest
constexpr double tooth_spacing_mm = 0.25, free_spacing_mm = 0.3, jaw_spacing_mm = 0.4,
                 cranium_spacing_mm = 0.5;
constexpr double band_mm = 1;
constexpr double tooth_sample_mm = 0.4, bone_sample_mm = 0.6;
// Of a guided pair: fields reach little farther than twice the gap. Wider gaps are kept by exact
// distances alone.
constexpr double widest_gap_mm = 4;
// Half of what the exact surfaces allow: then they seldom disagree.
constexpr double slop_mm = 0.01;
constexpr double fade_mm = 2;  // from rest, where overlap that is there at rest must be gone
// Between looks along a way, of points as far from the middle as those of a jaw.
constexpr double sight_step_mm = 5, turning_mm = 80;
constexpr double ways_out_mm[] = {4, 8, 16};
constexpr std::size_t most_settings = 24;

double spacing_of(const Part& part) {
  if (is_teeth(part.role)) return tooth_spacing_mm;
  switch (body_of(part.role)) {
    case Body::free:
      return free_spacing_mm;
    case Body::mandible:
      return jaw_spacing_mm;
    default:
      return cranium_spacing_mm;
  }
}

}  // namespace

Slider::Slider(const Case& patient, const ContactModel::State& state) : state_(state) {
  std::vector<Box> boxes(static_cast<std::size_t>(state.body_count()));
  for (const auto& collider : state.colliders)
    boxes[static_cast<std::size_t>(collider->body)].add(collider->surface.box());
  for (const auto& collider : state.colliders) {
    if (collider->guard) continue;
    const Part& part = patient.parts[static_cast<std::size_t>(collider->part)];
    Surface surface{collider->number, part.mesh, {}, nullptr, {}};
    FieldSettings& field = surface.settings.field;
    field.spacing_mm = spacing_of(part);
    field.band_mm = band_mm;
    for (const auto& pair : state.pairs)
      if ((pair.a == collider.get() || pair.b == collider.get()) && pair.kept_mm <= widest_gap_mm)
        field.band_mm = std::max(field.band_mm, 2 * pair.kept_mm + 0.5 * band_mm);
    if (collider->body < first_free_body) {  // a free part may go anywhere, and is small
      field.region.emplace();
      for (int body = 0; body < state.body_count(); ++body)
        if (body != collider->body) field.region->add(boxes[static_cast<std::size_t>(body)]);
      // Nothing else is there: a field of one place, which nobody will ask.
      if (field.region->empty()) field.region->add(collider->surface.box().low);
      field.region->low.array() -= reach_mm;
      field.region->high.array() += reach_mm;
    }
    surface.settings.samples.spacing_mm = is_teeth(part.role) ? tooth_sample_mm : bone_sample_mm;
    surface.settings.cache = field_cache_folder();
    surface.sight = field_sight(collider->surface.box(), field.region);
    surfaces_.push_back(std::move(surface));
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
    surface.body = std::make_shared<const SlideBody>(make_slide_body(
        surface.mesh, surface.settings, threads, [&](std::string_view, double share) {
          report(progress, "making the bones ready to slide",
                 (static_cast<double>(i) + share) / static_cast<double>(surfaces_.size()));
        }));
    surface.mesh = {};
    surface.sight.thin = is_thin(*surface.body);
  }
  contacts_.resize(static_cast<std::size_t>(state_.body_count()));
  outside_.resize(contacts_.size());
  for (int body = mandible_body; body < state_.body_count(); ++body) {
    contacts_[static_cast<std::size_t>(body)] = make_contact(body);
    outside_[static_cast<std::size_t>(body)] = find_outside(body);
  }
  report(progress, "making the bones ready to slide", 1);
  ready_ = true;
}

std::unique_ptr<SlidingContact> Slider::make_contact(int body) const {
  const Drive drive = make_drive(state_, std::vector<Pose>(contacts_.size()), body, {});
  std::vector<std::shared_ptr<const SlideBody>> fixed, moving;
  std::vector<int> place(state_.colliders.size(), -1);
  for (const Surface& surface : surfaces_) {
    const auto number = static_cast<std::size_t>(surface.collider);
    auto& side =
        drive.moves[static_cast<std::size_t>(state_.colliders[number]->body)] ? moving : fixed;
    place[number] = static_cast<int>(side.size());
    side.push_back(surface.body);
  }
  std::vector<SlidePair> pairs;
  for (const auto& pair : state_.pairs) {
    if (!drive.concerns(pair) || pair.kept_mm > widest_gap_mm) continue;
    int a = place[static_cast<std::size_t>(pair.a->number)],
        b = place[static_cast<std::size_t>(pair.b->number)];
    if (drive.moves[static_cast<std::size_t>(pair.a->body)]) std::swap(a, b);
    pairs.push_back({a, b, pair.kept_mm});
  }
  auto contact = std::make_unique<SlidingContact>(
      std::move(fixed), std::move(moving), pairs,
      SlideSettings{.friction = state_.settings.friction, .slop_mm = slop_mm, .pivot = {}});
  contact->allow_overlap_at({}, fade_mm);
  return contact;
}

std::optional<Pose> Slider::find_outside(int body) const {
  const Drive drive = make_drive(state_, std::vector<Pose>(contacts_.size()), body, {});
  Eigen::Vector3d out = Eigen::Vector3d::Zero();  // of what it lies in, on the whole
  for (std::size_t i = 0; i < state_.pairs.size(); ++i) {
    const ColliderPair& pair = state_.pairs[i];
    if (!drive.concerns(pair) || pair.rest_depth_mm <= deep_mm) continue;
    const double sign = drive.moves[static_cast<std::size_t>(pair.a->body)] ? -1 : 1;
    for (const ContactPoint& contact : state_.rest.pairs[i].contacts) out += sign * contact.normal;
  }
  if (!(out.norm() > 0)) return std::nullopt;
  for (const double way_mm : ways_out_mm) {
    const Pose X{Eigen::Quaterniond::Identity(), way_mm * out.normalized()};
    if (contact(body).depth(X) == 0) return X;
  }
  return std::nullopt;
}

std::optional<Pose> Slider::outside(const Drive& drive) const {
  for (std::size_t b = 0; b < drive.X_CB.size(); ++b)
    if (drive.moves[b] ? drive.X_DM[b].has_value() : !same_bits(drive.X_CB[b], {}))
      return std::nullopt;
  return outside_[static_cast<std::size_t>(drive.body)];
}

bool Slider::sees(const Drive& drive) const {
  std::vector<const FieldSight*> of(state_.colliders.size(), nullptr);
  for (const Surface& surface : surfaces_)
    of[static_cast<std::size_t>(surface.collider)] = &surface.sight;
  const double way_mm = (drive.wanted.t - drive.from().t).norm() +
                        rotation_angle(drive.from().inverse() * drive.wanted) * turning_mm;
  const int looks = 1 + static_cast<int>(way_mm / sight_step_mm);
  std::vector<std::vector<Pose>> X_CB;
  for (int i = 0; i <= looks; ++i)
    X_CB.push_back(drive.poses_at(interpolate(drive.from(), drive.wanted,
                                              static_cast<double>(i) / looks, pivot(drive.body))));
  return std::none_of(state_.pairs.begin(), state_.pairs.end(), [&](const ColliderPair& pair) {
    if (!drive.concerns(pair)) return false;
    const FieldSight &a = *of[static_cast<std::size_t>(pair.a->number)],
                     &b = *of[static_cast<std::size_t>(pair.b->number)];
    if ((a.thin && b.thin) || pair.kept_mm > widest_gap_mm) return true;
    // A jaw does not leave its joints far enough to bring anything else to what is outside.
    if (pair.b->body < first_free_body) return a.blind || b.blind;
    return std::any_of(X_CB.begin(), X_CB.end(), [&](const std::vector<Pose>& X) {
      const Pose X_AB = X[static_cast<std::size_t>(pair.a->body)].inverse() *
                        X[static_cast<std::size_t>(pair.b->body)];
      const auto meets = [&](const Box& box_a, const Box& box_b) {
        return boxes_meet(box_a, box_b, X_AB, 0.5 * sight_step_mm + pair.kept_mm);
      };
      return std::any_of(a.outside.begin(), a.outside.end(),
                         [&](const Box& box) { return meets(box, b.box); }) ||
             std::any_of(b.outside.begin(), b.outside.end(),
                         [&](const Box& box) { return meets(a.box, box); });
    });
  });
}

std::unique_ptr<Slider::Setting> Slider::take_setting(const Drive& drive) const {
  std::vector<Pose> X_FS, X_MS;
  for (const Surface& surface : surfaces_) {
    const auto body = static_cast<std::size_t>(
        state_.colliders[static_cast<std::size_t>(surface.collider)]->body);
    if (!drive.moves[body])
      X_FS.push_back(drive.X_CB[body]);
    else
      X_MS.push_back(drive.X_DM[body].value_or(Pose{}));
  }
  const auto alike = [](const std::vector<Pose>& x, const std::vector<Pose>& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), same_bits);
  };
  std::unique_ptr<Setting> setting;
  {
    const std::lock_guard lock(settings_mutex_);
    auto best = settings_.end();
    for (auto it = settings_.begin(); it != settings_.end(); ++it)
      if ((*it)->body == drive.body) {
        best = it;
        if (alike((*it)->X_FS, X_FS) && alike((*it)->X_MS, X_MS)) break;
      }
    if (best != settings_.end()) {
      setting = std::move(*best);
      settings_.erase(best);
    }
  }
  if (!setting)
    setting = std::make_unique<Setting>(Setting{drive.body, {}, {}, contact(drive.body), {}});
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
  if (settings_.size() > most_settings) settings_.erase(settings_.begin());
}

SlideResult Slider::slide(const Drive& drive, const Pose& from, const Pose& wanted,
                          int threads) const {
  auto setting = take_setting(drive);
  SlideResult result = setting->contact.slide(from, wanted, &setting->memory, threads);
  keep_setting(std::move(setting));
  return result;
}

}  // namespace condyle
