#include "render/window/view_state.h"

namespace condyle {

bool ViewState::shows_face(const WindowScene& scene) const {
  if (skin_opacity <= 0) return false;
  for (std::size_t i = 0; i < scene.parts.size(); ++i)
    if (scene.parts[i].role == Role::face && i < parts.size() && parts[i].shown &&
        parts[i].opacity > 0)
      return true;
  return false;
}

void ViewState::fit(const WindowScene& scene) {
  constexpr PartView muscle{.shown = false}, layer{.shown = false, .opacity = 0.5};
  parts.resize(scene.parts.size());
  muscles.resize(scene.muscles.size(), muscle);
  layers.resize(scene.layers.size(), layer);
}

Edits Edits::of(const ViewState& view) {
  return {view.hands,        view.measured,      view.landmarks, view.motion,    view.look,
          view.obey_contact, view.mark_contacts, view.shadows,   view.distances, view.skin_opacity,
          view.parts,        view.muscles,       view.layers};
}

void Edits::put_into(ViewState& view) const {
  view.hands = hands;
  view.measured = measured;
  view.landmarks = landmarks;
  view.motion = motion;
  view.look = look;
  view.obey_contact = obey_contact;
  view.mark_contacts = mark_contacts;
  view.shadows = shadows;
  view.distances = distances;
  view.skin_opacity = skin_opacity;
  view.parts = parts;
  view.muscles = muscles;
  view.layers = layers;
  if (view.landmark && *view.landmark >= landmarks.size()) view.landmark.reset();
}

std::map<std::string, double> part_opacities(const WindowScene& scene, const ViewState& view) {
  std::map<std::string, double> opacities;
  for (std::size_t i = 0; i < scene.parts.size() && i < view.parts.size(); ++i)
    opacities[scene.parts[i].name] = view.parts[i].shown ? view.parts[i].opacity : 0;
  return opacities;
}

}  // namespace condyle
