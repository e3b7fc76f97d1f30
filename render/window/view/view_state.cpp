#include "render/window/view/view_state.h"

#include <algorithm>
#include <utility>

namespace condyle {
namespace {

/// Eyes, gums and tongue: without the skin that holds them they float.
bool is_behind_skin(Role role) {
  return role == Role::eyes || role == Role::upper_gums || role == Role::lower_gums ||
         role == Role::tongue;
}

}  // namespace

bool ViewState::shows_face(const WindowScene& scene) const {
  if (skin_opacity <= 0) return false;
  for (std::size_t i = 0; i < scene.parts.size(); ++i)
    if (scene.parts[i].role == Role::face && i < parts.size() && parts[i].shown &&
        parts[i].opacity > 0)
      return true;
  return false;
}

bool ViewState::simulates_tissue(const WindowScene& scene) const {
  return shows_face(scene) || look.springs || look.prisms || look.bone_springs ||
         look.facial_muscles ||
         std::any_of(layers.begin(), layers.end(),
                     [](const PartView& layer) { return layer.shown; });
}

void ViewState::fit(const WindowScene& scene) {
  constexpr PartView muscle{.shown = false}, layer{.shown = false, .opacity = 0.5};
  parts.resize(scene.parts.size());
  if (selected && *selected >= scene.parts.size()) selected.reset();
  if (drawn_cut.part && *drawn_cut.part >= scene.parts.size()) drawn_cut = {};
  muscles.resize(scene.muscles.size(), muscle);
  layers.resize(scene.layers.size(), layer);
}

void ViewState::move(const MovableBody& body, const Pose& target, const Pose& X_CM) {
  if (!body.roams()) {
    if (body.is_skull() && opening_mm) hands.set(hands.jaw, X_CM);
    opening_mm.reset();
    playing = false;
  }
  hands.move(body, target, X_CM);
}

void ViewState::return_skin() {
  const auto before = std::exchange(skin_to_return, std::nullopt);
  if (before && skin_opacity == 0) skin_opacity = *before;
}

void ViewState::set_edits(Edits other) {
  static_cast<Edits&>(*this) = std::move(other);
  if (jaw_is_held()) playing = false;
  if (landmark && *landmark >= landmarks.size()) landmark.reset();
}

std::map<std::string, double> part_opacities(const WindowScene& scene, const ViewState& view) {
  std::map<std::string, double> opacities;
  const bool without_skin = view.skin_opacity <= 0 &&
                            std::any_of(scene.parts.begin(), scene.parts.end(),
                                        [](const Part& part) { return part.role == Role::face; });
  for (std::size_t i = 0; i < scene.parts.size() && i < view.parts.size(); ++i) {
    const Part& part = scene.parts[i];
    const bool bare = without_skin && is_behind_skin(part.role);
    opacities[part.name] = view.parts[i].shown && !bare ? view.parts[i].opacity : 0;
  }
  return opacities;
}

}  // namespace condyle
