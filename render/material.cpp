#include "render/material.h"

namespace condyle {

Material material_of(Role role) {
  switch (role) {
    case Role::skull:
    case Role::maxilla:
      return {{.90f, .86f, .76f}, .55f, .022f, .18f, {.10f, .06f, .03f}, 0};
    case Role::mandible:
      return {{.84f, .79f, .68f}, .55f, .022f, .18f, {.10f, .06f, .03f}, 0};
    case Role::upper_teeth:
    case Role::lower_teeth:
      return {{.97f, .95f, .90f}, .26f, .040f, .28f, {.30f, .24f, .15f}, .35f};
    case Role::face:
      return {{.83f, .65f, .55f}, .48f, .028f, .30f, {.42f, .24f, .16f}, 0};
    case Role::eyes:
      return {{.95f, .94f, .92f}, .10f, .035f, .25f, {.20f, .12f, .10f}, 1.f};
    case Role::upper_gums:
    case Role::lower_gums:
      return {{.80f, .48f, .47f}, .36f, .035f, .30f, {.45f, .12f, .10f}, .5f};
    case Role::tongue:
      return {{.78f, .44f, .44f}, .45f, .035f, .30f, {.45f, .12f, .10f}, .35f};
  }
  return {{.8f, .8f, .8f}, .5f, .03f, .2f, {0, 0, 0}, 0};
}

}  // namespace condyle
