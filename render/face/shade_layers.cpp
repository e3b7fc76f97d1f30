#include "render/face/shade_layers.h"

namespace condyle {

void set_shade_layers(const Part& part, BodyId lower_jaw, OcclusionSurface& surface) {
  enum { cranium, mandible, face, others };
  const Role role = part.role;
  if (role == Role::face) {
    surface.layer = face;
    surface.alone = surface.together = 1u << face;
  } else if (role == Role::eyes) {
    surface.layer = cranium;
    surface.alone = 1u << cranium;
    surface.together = 1u << cranium | 1u << face;
  } else if (part.body != cranium_body && part.body != lower_jaw) {
    surface.layer = others;
    surface.alone = surface.together = 1u << others;
  } else {
    surface.layer = part.body == lower_jaw ? mandible : cranium;
    surface.alone = 1u << surface.layer;
    surface.together = 1u << cranium | 1u << mandible;
  }
}

}  // namespace condyle
