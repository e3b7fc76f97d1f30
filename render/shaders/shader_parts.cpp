#include "render/shaders/shader_parts.h"

#include "render/shaders/shaders.h"
#include "render/shaders/skin_detail.h"

namespace condyle {

// Offset along the normal, increasing towards grazing light, so that a surface does not shade
// itself; an open one towards the visible side. Lips (gloss 1) turn over as they open: their
// coarser shadow caster deviates from them by more than elsewhere.
const char* const shade_offset_source = R"(
vec3 shade_offset(vec3 n, vec3 key, vec3 to_eye, float open, float gloss) {
  float offset = 0.6 + 2.0 * (1.0 - abs(dot(n, key))) + 1.2 * gloss;
  return (open > 0.5 && dot(n, to_eye) < 0.0 ? -offset : offset) * n;
}
)";

const char* const backdrop_source = R"(
uniform vec2 pixel;  // 1 / size of the picture
uniform int light;
vec3 backdrop() {
  vec2 place = gl_FragCoord.xy * pixel;  // of the whole pixel, independent of sampling
  // A pool of light behind the head; half a grey level of ordered noise hides the bands.
  float pool = exp(-2.2 * dot(place - vec2(0.5, 0.48), place - vec2(0.5, 0.48)));
  vec3 c = mix(vec3(0.085, 0.090, 0.100), vec3(0.295, 0.305, 0.325), pool * (0.55 + 0.45 * place.y));
  if (light == 1)
    c = mix(vec3(0.740, 0.765, 0.790), vec3(0.905, 0.915, 0.925), pool * (0.55 + 0.45 * place.y));
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  int rank = ((cell.x ^ cell.y) & 1) * 8 + (cell.y & 1) * 4
           + (((cell.x ^ cell.y) >> 1) & 1) * 2 + ((cell.y >> 1) & 1);
  return c + (float(rank) / 15.0 - 0.5) / 255.0;
}
)";

namespace {

// `invariant`: a part that is drawn twice must have identical depths.
const char* const vertex_source = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;  // sRGB, occlusion with everything at rest
// occlusion by its own body; curvature, of a tongue: smoothness; gloss; fraction of lip, of eyes:
// radius of a lash
layout(location = 3) in vec4 extra;
layout(location = 4) in float value;  // value of a colour map
layout(location = 5) in vec3 rest;  // position at rest, of skin; of a tongue: on its back
uniform mat4 model;            // rigid
uniform mat4 view_projection;
uniform mat4 shadow_matrix;
uniform vec3 eye, key_direction;
uniform float two_sided;       // 1 when the surface is open
uniform float together;  // 1 with everything at rest, 0 far from it
uniform vec2 cavity;           // y where the mouth's darkness starts, 1/length; 0 length = none
uniform vec4 clip_plane;  // kept: dot(plane, position) > 0
uniform vec4 cut_ball;  // centre and radius; the outside is kept
uniform vec2 lashes;  // mm of a radius of 1; least radius at distance 1, mm; 0: as they are
uniform vec3 behind_lashes;  // sRGB
uniform vec4 window_ball;  // the same, of the skin: the mouth's darkness is not applied through it
out float gl_ClipDistance[2];
invariant gl_Position;
out vec3 to_eye;
out vec3 world_normal;
out vec3 albedo;               // linear
out vec3 shadow_place;
out vec4 traits;  // occlusion, curvature (of eyes: 1 on lashes), gloss, depth in the mouth at rest
out float mapped_value;
out vec3 rest_place;
void main() {
  mapped_value = value;
  rest_place = rest;
  vec4 world = model * vec4(position, 1.0);
  world_normal = mat3(model) * normal;
  // A lash thinner than a pixel is drawn as wide, with as much of the skin's colour.
  float radius = lashes.x * extra.w;
  float thin = radius > 0.0 ? max(lashes.y * distance(eye, world.xyz) - radius, 0.0) : 0.0;
  world.xyz += thin * world_normal;
  gl_Position = view_projection * world;
  gl_ClipDistance[0] = dot(clip_plane, world);
  gl_ClipDistance[1] = distance(world.xyz, cut_ball.xyz) - cut_ball.w;
  to_eye = eye - world.xyz;
  albedo = pow(mix(color.rgb, behind_lashes, thin / max(radius + thin, 1e-6)), vec3(2.2));
  shadow_place = (shadow_matrix * vec4(world.xyz + shade_offset(world_normal, key_direction, to_eye,
                                                                two_sided, extra.z), 1.0)).xyz;
  vec3 offset = window_ball.xyz - eye;
  float nearest = clamp(-dot(offset, to_eye) / dot(to_eye, to_eye), 0.0, 1.0);
  float beside_window = distance(offset, -nearest * to_eye) - window_ball.w;
  traits = vec4(mix(extra.x, color.a, together), extra.y, extra.z,
                mix(1.0, exp(-max(position.y - cavity.x, 0.0) * cavity.y),
                    smoothstep(-2.0, 0.0, beside_window) * (1.0 - extra.w)));
  if (radius > 0.0) traits.y = 1.0;  // hair is not wet
}
)";

}  // namespace

std::string surface_vertices() {
  return std::string("#version 330 core\n") + shade_offset_source + vertex_source;
}

std::string shading_constants(const Shading& shading) {
  std::string text = "#version 330 core\n";
  const auto fixed = [&](const char* name, bool value) {
    text += std::string("const bool ") + name + " = " + (value ? "true" : "false") + ";\n";
  };
  fixed("shadowed", shading.shadowed);
  fixed("mapped", shading.mapped);
  fixed("coated", shading.coated);
  fixed("cuttable", shading.cuttable);
  fixed("seen_through", shading.seen_through);
  fixed("skin", shading.skin);
  fixed("smooth_skin", shading.smooth_skin);
  fixed("papillae", shading.papillae);
  fixed("vanishing", shading.vanishing);
  const auto number = [&](const char* name, int value) {
    text += std::string("const float ") + name + " = " + std::to_string(value) + ".0;\n";
  };
  // Period of the skin detail, mm; both patterns repeat after the product.
  constexpr int fine = 21, coarse = 83;
  number("fine_period", fine);
  number("coarse_period", coarse);
  number("rest_period", fine * coarse);
  number("detail_side", SkinDetail::side);
  // Size of a cell of skin over that of a lip's furrow, which repeats after the same product.
  const auto ratio = [](int cells) { return std::to_string(static_cast<double>(cells) / coarse); };
  text += "const vec3 lip_cells = vec3(" + ratio(60) + ", " + ratio(20) + ", " + ratio(13) + ");\n";
  return text;
}

}  // namespace condyle
