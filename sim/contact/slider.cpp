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
    Surface surface{collider->number, part.mesh, {}, nullptr};
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
      field.region->low.array() -= reach_mm;
      field.region->high.array() += reach_mm;
    }
    surface.settings.samples.spacing_mm = is_teeth(part.role) ? tooth_sample_mm : bone_sample_mm;
    surface.settings.cache = field_cache_folder();
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
    surface.body =
        std::make_shared<const SlideBody>(make_slide_body(surface.mesh, surface.settings, threads));
    surface.mesh = {};
  }
  contacts_.resize(static_cast<std::size_t>(state_.body_count()));
  for (int body = mandible_body; body < state_.body_count(); ++body)
    contacts_[static_cast<std::size_t>(body)] = make_contact(body);
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
      SlideSettings{.friction = state_.settings.friction, .pivot = {}});
  contact->allow_overlap_at({});
  return contact;
}

bool Slider::knows(const Drive& drive) const {
  for (std::size_t b = 0; b < drive.X_CB.size(); ++b)
    if (drive.moves[b] ? drive.X_DM[b].has_value() : !same_bits(drive.X_CB[b], {})) return false;
  return true;
}

Pose Slider::slide(const Drive& drive, const Pose& from, const Pose& wanted, int threads) const {
  return contact(drive.body).slide(from, wanted, nullptr, threads).X_FM;
}

}  // namespace condyle
