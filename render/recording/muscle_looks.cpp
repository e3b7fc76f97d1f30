#include "render/recording/muscle_looks.h"

#include <algorithm>
#include <array>

namespace condyle {
namespace {

using Eigen::Vector3f;
using Thin = BellyShape::Thin;

struct GroupLook {
  MuscleGroup group;
  const char* words;
  Vector3f idle, excited;  // differ in lightness too
};

const std::array<GroupLook, 5>& group_looks() {
  static const std::array<GroupLook, 5> looks = {{
      {MuscleGroup::elevator, "Elevators", {.66f, .24f, .14f}, {1.f, .58f, .36f}},
      {MuscleGroup::protrusor, "Protrusors", {.80f, .54f, .08f}, {1.f, .86f, .42f}},
      {MuscleGroup::depressor, "Depressors", {.10f, .38f, .60f}, {.48f, .76f, 1.f}},
      {MuscleGroup::hyoid, "Hyoid muscles", {.08f, .50f, .38f}, {.42f, .88f, .72f}},
      {MuscleGroup::facial, "Facial muscles", {.66f, .36f, .52f}, {.95f, .68f, .84f}},
  }};
  return looks;
}

const GroupLook& look_of(MuscleGroup group) {
  return *std::find_if(group_looks().begin(), group_looks().end(),
                       [&](const GroupLook& look) { return look.group == group; });
}

KeyEntry key_of(const GroupLook& look) {
  return {std::string(look.words) + ", at rest to excited",
          {look.idle, look.excited},
          KeyEntry::Mark::scale};
}

struct KindLook {
  std::string_view kind;
  MuscleGroup group;
  BellyShape shape;
};

constexpr std::array<KindLook, 17> kind_looks = {{
    {"at", MuscleGroup::elevator, {3.4, 1.15, 0.45, Thin::lateral, Lie::fan}},
    {"mt", MuscleGroup::elevator, {4, 1.2, 0.35, Thin::lateral, Lie::fan}},
    {"pt", MuscleGroup::elevator, {4, 1.2, 0.35, Thin::lateral, Lie::fan}},
    {"sm", MuscleGroup::elevator, {2.8, 0.8, 0.85, Thin::lateral}},
    {"dm", MuscleGroup::elevator, {2.8, 1, 0.9, Thin::lateral}},
    {"mp", MuscleGroup::elevator, {2.2, 0.7, 0.9, Thin::medial}},
    {"sp", MuscleGroup::protrusor, {1.6, 1.1, 0.6, Thin::vertical, Lie::straight}},
    {"ip", MuscleGroup::protrusor, {1.6, 1.1, 0.6, Thin::medial}},
    {"ad", MuscleGroup::depressor, {1.5, 0.8, 0.5, Thin::vertical, Lie::straight}},
    {"am", MuscleGroup::depressor, {3.5, 1.1, 0.7, Thin::vertical, Lie::straight}},
    {"pm", MuscleGroup::depressor, {3.5, 1.1, 0.7, Thin::vertical, Lie::straight}},
    {"gh", MuscleGroup::depressor, {1.3, 0.7, 0.9, Thin::vertical, Lie::straight}},
    {"pd", MuscleGroup::hyoid, {1.4, 0.8, 0.5, Thin::lateral}},
    {"sh", MuscleGroup::hyoid, {1.3, 0.6, 0.6, Thin::lateral}},
    {"th", MuscleGroup::hyoid, {2.5, 0.9, 0.9, Thin::front, Lie::straight}},
    {"steh", MuscleGroup::hyoid, {2, 0.6, 0.9, Thin::front, Lie::straight}},
    {"oh", MuscleGroup::hyoid, {2, 0.7, 0.8, Thin::front, Lie::straight}},
}};

const KindLook* kind_look(std::string_view kind) {
  const auto found = std::find_if(kind_looks.begin(), kind_looks.end(),
                                  [&](const KindLook& look) { return look.kind == kind; });
  return found == kind_looks.end() ? nullptr : &*found;
}

}  // namespace

MuscleGroup group_of(const Muscle& muscle) {
  if (const KindLook* look = kind_look(muscle.kind)) return look->group;
  if (muscle.group == "closer") return MuscleGroup::elevator;
  if (muscle.group == "opener") return MuscleGroup::depressor;
  if (muscle.group.starts_with("protruder")) return MuscleGroup::protrusor;
  return muscle.moves(MuscleBody::mandible) ? MuscleGroup::elevator : MuscleGroup::hyoid;
}

Vector3f muscle_color(MuscleGroup group, double excitation) {
  const GroupLook& look = look_of(group);
  const auto t = static_cast<float>(std::clamp(excitation, 0.0, 1.0));
  return look.idle + t * (look.excited - look.idle);
}

std::vector<KeyEntry> muscle_key(std::span<const Muscle> muscles) {
  std::vector<KeyEntry> key;
  for (const GroupLook& look : group_looks())
    if (std::any_of(muscles.begin(), muscles.end(),
                    [&](const Muscle& muscle) { return group_of(muscle) == look.group; }))
      key.push_back(key_of(look));
  return key;
}

KeyEntry facial_muscle_key() {
  const GroupLook& look = look_of(MuscleGroup::facial);
  return {look.words, {look.idle}, KeyEntry::Mark::sheet};
}

BellyShape belly_shape(std::string_view kind) {
  const KindLook* look = kind_look(kind);
  return look ? look->shape : BellyShape{};
}

double belly_area_mm2(double max_force_N) {
  constexpr double N_per_mm2 = 0.4, least = 20;
  return std::max(max_force_N / N_per_mm2, least);
}

}  // namespace condyle
