#include "render/recording/muscle_looks.h"

#include <algorithm>
#include <array>

namespace condyle {
namespace {

using Eigen::Vector3f;
using Thin = BellyShape::Thin;

struct ActionLook {
  MuscleAction group;
  const char* words;
  Vector3f idle, excited;  // differ in lightness too
};

const std::array<ActionLook, 5>& group_looks() {
  static const std::array<ActionLook, 5> looks = {{
      {MuscleAction::elevator, "Elevators", {.66f, .24f, .14f}, {1.f, .58f, .36f}},
      {MuscleAction::protrusor, "Protrusors", {.80f, .54f, .08f}, {1.f, .86f, .42f}},
      {MuscleAction::depressor, "Depressors", {.10f, .38f, .60f}, {.48f, .76f, 1.f}},
      {MuscleAction::hyoid, "Hyoid muscles", {.08f, .50f, .38f}, {.42f, .88f, .72f}},
      {MuscleAction::facial, "Facial muscles", {.66f, .36f, .52f}, {.95f, .68f, .84f}},
  }};
  return looks;
}

const ActionLook& look_of(MuscleAction group) {
  return *std::find_if(group_looks().begin(), group_looks().end(),
                       [&](const ActionLook& look) { return look.group == group; });
}

KeyEntry key_of(const ActionLook& look) {
  return {std::string(look.words) + ", at rest to excited",
          {look.idle, look.excited},
          KeyEntry::Mark::scale};
}

struct KindLook {
  std::string_view kind;
  MuscleAction group;
  BellyShape shape;
};

constexpr std::array<KindLook, 17> kind_looks = {{
    {"at", MuscleAction::elevator, {3.4, 1.15, 0.45, Thin::lateral, Lie::fan}},
    {"mt", MuscleAction::elevator, {4, 1.2, 0.35, Thin::lateral, Lie::fan}},
    {"pt", MuscleAction::elevator, {4, 1.2, 0.35, Thin::lateral, Lie::fan}},
    {"sm", MuscleAction::elevator, {2.8, 0.8, 0.85, Thin::lateral}},
    {"dm", MuscleAction::elevator, {2.8, 1, 0.9, Thin::lateral}},
    {"mp", MuscleAction::elevator, {2.2, 0.7, 0.9, Thin::medial}},
    {"sp", MuscleAction::protrusor, {1.6, 1.1, 0.6, Thin::vertical, Lie::straight}},
    {"ip", MuscleAction::protrusor, {1.6, 1.1, 0.6, Thin::medial}},
    {"ad", MuscleAction::depressor, {1.5, 0.8, 0.5, Thin::vertical, Lie::straight}},
    {"am", MuscleAction::depressor, {3.5, 1.1, 0.7, Thin::vertical, Lie::straight}},
    {"pm", MuscleAction::depressor, {3.5, 1.1, 0.7, Thin::vertical, Lie::straight}},
    {"gh", MuscleAction::depressor, {1.3, 0.7, 0.9, Thin::vertical, Lie::straight}},
    {"pd", MuscleAction::hyoid, {1.4, 0.8, 0.5, Thin::lateral}},
    {"sh", MuscleAction::hyoid, {1.3, 0.6, 0.6, Thin::lateral}},
    {"th", MuscleAction::hyoid, {2.5, 0.9, 0.9, Thin::front, Lie::straight}},
    {"steh", MuscleAction::hyoid, {2, 0.6, 0.9, Thin::front, Lie::straight}},
    {"oh", MuscleAction::hyoid, {2, 0.7, 0.8, Thin::front, Lie::straight}},
}};

const KindLook* kind_look(std::string_view kind) {
  const auto found = std::find_if(kind_looks.begin(), kind_looks.end(),
                                  [&](const KindLook& look) { return look.kind == kind; });
  return found == kind_looks.end() ? nullptr : &*found;
}

}  // namespace

MuscleAction action_of(const Muscle& muscle) {
  if (const KindLook* look = kind_look(muscle.kind)) return look->group;
  if (muscle.group == "closer") return MuscleAction::elevator;
  if (muscle.group == "opener") return MuscleAction::depressor;
  if (muscle.group.starts_with("protruder")) return MuscleAction::protrusor;
  return muscle.moves(MuscleBody::mandible) ? MuscleAction::elevator : MuscleAction::hyoid;
}

Vector3f muscle_color(MuscleAction group, double excitation) {
  const ActionLook& look = look_of(group);
  const auto t = static_cast<float>(std::clamp(excitation, 0.0, 1.0));
  return look.idle + t * (look.excited - look.idle);
}

std::vector<KeyEntry> muscle_key(std::span<const Muscle> muscles) {
  std::vector<KeyEntry> key;
  for (const ActionLook& look : group_looks())
    if (std::any_of(muscles.begin(), muscles.end(),
                    [&](const Muscle& muscle) { return action_of(muscle) == look.group; }))
      key.push_back(key_of(look));
  return key;
}

KeyEntry facial_muscle_key() {
  const ActionLook& look = look_of(MuscleAction::facial);
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
