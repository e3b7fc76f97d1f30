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

Edits Edits::of(const ViewState& view) {
  return {view.hands, view.measured, view.landmarks, view.motion};
}

void Edits::put_into(ViewState& view) const {
  view.hands = hands;
  view.measured = measured;
  view.landmarks = landmarks;
  view.motion = motion;
  if (view.landmark && *view.landmark >= landmarks.size()) view.landmark.reset();
}

std::map<std::string, double> part_opacities(const WindowScene& scene, const ViewState& view) {
  std::map<std::string, double> opacities;
  for (std::size_t i = 0; i < scene.parts.size() && i < view.parts.size(); ++i)
    opacities[scene.parts[i].name] = view.parts[i].shown ? view.parts[i].opacity : 0;
  return opacities;
}

}  // namespace condyle
