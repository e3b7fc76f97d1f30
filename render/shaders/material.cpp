#include "render/shaders/material.h"

namespace condyle {

Material material_of(Role role) {
  switch (role) {
    case Role::skull:
    case Role::maxilla:
      return {{.90f, .85f, .75f}, .55f, .022f, .18f, {.14f, .08f, .04f}, 0};
    case Role::mandible:
      return {{.85f, .79f, .68f}, .55f, .022f, .18f, {.14f, .08f, .04f}, 0};
    case Role::segment:
      return {{.86f, .74f, .52f}, .55f, .022f, .18f, {.14f, .08f, .04f}, 0};
    case Role::transplant:
      return {{.62f, .78f, .74f}, .50f, .025f, .18f, {.10f, .10f, .06f}, 0};
    case Role::upper_teeth:
    case Role::lower_teeth:
      return {{.95f, .92f, .85f}, .30f, .040f, .28f, {.30f, .22f, .13f}, .30f};
    case Role::face:
      return {{.83f, .65f, .55f}, .48f, .028f, .30f, {.42f, .24f, .16f}, 0};
    case Role::eyes:
      return {{.95f, .94f, .92f}, .10f, .035f, .25f, {.20f, .12f, .10f}, 1.f};
    case Role::upper_gums:
    case Role::lower_gums:
      return {{.76f, .45f, .43f}, .42f, .030f, .30f, {.45f, .12f, .10f}, .3f};
    case Role::tongue:
      return {{.78f, .47f, .46f}, .42f, .034f, .32f, {.45f, .12f, .10f}, .45f};
  }
  return {{.8f, .8f, .8f}, .5f, .03f, .2f, {0, 0, 0}, 0};
}

Eigen::Vector3f cut_color_of(Role role) {
  switch (role) {
    case Role::upper_teeth:
    case Role::lower_teeth:
      return {.93f, .90f, .80f};
    case Role::face:
      return {.60f, .55f, .53f};  // neutral: fat, muscle and brain are not distinguished
    case Role::eyes:
      return {.86f, .88f, .88f};
    case Role::upper_gums:
    case Role::lower_gums:
    case Role::tongue:
      return {.64f, .43f, .41f};
    case Role::transplant:
      return {.52f, .72f, .68f};
    default:
      return {.86f, .72f, .55f};  // marrow and spongy bone
  }
}

}  // namespace condyle
