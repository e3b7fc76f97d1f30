#include "render/shaders/shader_parts.h"
#include "render/shaders/shaders.h"

namespace condyle {
namespace {

// Inputs of lighting of the triangle being drawn.
const char* const triangle_source = R"(
in vec3 to_eye;
in vec3 world_normal;
in vec3 albedo;
in vec3 shadow_place;
in vec4 traits;
in vec3 rest_place;
in float mapped_value;
void begin() {}
)";

const char* const lighting_source = R"(
uniform vec3 key_direction, key_color;
uniform vec3 fill_direction, fill_color;
uniform vec3 rim_direction, rim_color;
uniform vec3 sky_direction, sky_color, ground_color, front_color;
uniform sampler2DShadow shadow_map;
uniform sampler2D shadow_depth;  // the same, read without comparison
uniform mat4 shadow_matrix;
uniform vec3 shadow_scale;       // of the shadow map's cube over mm
uniform float opacity;
out vec4 result;

// Rotation from one point of a sunflower spiral to the next, and to the fourth from there: such
// points are evenly distributed over a disc.
const float one_turn = 2.399963;
const mat2 next_point = mat2(-0.737369, 0.675490, -0.675490, -0.737369);
const mat2 fourth_point = mat2(-0.984713, -0.174182, 0.174182, -0.984713);

// Samples some points of a disc (radius in mm) in the shadow map and adds to `found`: x, the
// fraction of the light that is blocked, each 0 to 1; y, the same times the distance of the
// blocker, in fractions of the map's depth. The receiver continues along `slope`, depth per offset:
// a surface must not shade itself. Without a GPU a branch costs as much as it saves; a loop without
// iterations does not.
const int samples = 6;
void sample_shadow(bool needed, float radius, vec2 slope, inout vec2 point, inout vec2 found) {
  const float edge = 0.5;  // mm
  for (int i = 0; i < (needed ? samples : 0); ++i) {
    point = next_point * point;
    vec2 off = radius * sqrt((float(i) + 0.5) / float(samples)) * point * shadow_scale.xy;
    float before = shadow_place.z + dot(slope, off)
                 - textureLod(shadow_depth, shadow_place.xy + off, 0.0).r;
    float hidden = clamp(before / (edge * shadow_scale.z), 0.0, 1.0);
    found += vec2(hidden, hidden * before);
  }
}

// The key light is an area light: x is its visible fraction, y the half width of the penumbra, mm.
// The penumbra widens with the distance from the blocker; on skin it is never sharp. `needed`:
// false where no light arrives anyway.
// source: Fernando, Percentage-Closer Soft Shadows, 2005
vec2 key_visibility(vec3 n, bool needed) {
  const float box = 0.13;                 // half width of the light over its distance
  const float widest = 8.0, least = 1.3;  // mm
  const int compared = 12;
  if (!shadowed) return vec2(1.0, 0.0);
  vec3 plane = mat3(shadow_matrix) * n / (shadow_scale * shadow_scale);
  vec2 steepest = 4.0 * shadow_scale.z / shadow_scale.xy;
  vec2 slope = plane.z < -1e-6 ? clamp(-plane.xy / plane.z, -steepest, steepest) : vec2(0.0);
  vec2 point = vec2(1.0, 0.0), found = vec2(0.0);
  sample_shadow(needed, widest, slope, point, found);
  // Without many blockers the penumbra begins: it has no step.
  float fraction = min(0.4 * found.x, 1.0);
  bool shaded = found.x > 0.0;
  sample_shadow(shaded, widest, slope, point, found);
  float reach = clamp(box * found.y / (max(found.x, 1e-6) * shadow_scale.z), least, widest);
  // Four neighbouring pixels sample every fourth point of one spiral each, and share the results.
  // source: Jimenez, Next Generation Post Processing in Call of Duty: Advanced Warfare, 2014
  vec2 odd = mod(floor(gl_FragCoord.xy), 2.0);
  float own = odd.x + 2.0 * odd.y;
  point = vec2(cos(own * one_turn), sin(own * one_turn));
  float sum = 0.0;
  for (int i = 0; i < (shaded ? compared : 0); ++i) {
    vec2 off = reach * sqrt((float(4 * i) + own + 0.5) / float(4 * compared)) * point
             * shadow_scale.xy;
    sum += textureLod(shadow_map, shadow_place + vec3(off, dot(slope, off)), 0.0);
    point = fourth_point * point;
  }
  float seen = mix(1.0, sum / float(compared), fraction);
  // Neighbours farther apart, mm, or far brighter or darker belong to another surface.
  const float apart = 1.5, unlike = 0.35;
  vec3 right = dFdx(shadow_place) / shadow_scale, up = dFdy(shadow_place) / shadow_scale;
  float beside = dFdx(seen);
  if (dot(right, right) < apart * apart && abs(beside) < unlike) seen += (0.5 - odd.x) * beside;
  float above = dFdy(seen);
  if (dot(up, up) < apart * apart && abs(above) < unlike) seen += (0.5 - odd.y) * above;
  return vec2(seen, shaded ? reach : 0.0);
}

float wrapped(float cosine, float wrap) {
  return max(cosine + wrap, 0.0) / ((1.0 + wrap) * (1.0 + wrap));
}

vec3 ambient_light(vec3 n, vec3 v) {
  float up = 0.5 + 0.5 * dot(n, sky_direction);
  return mix(ground_color, sky_color, up) + front_color * max(dot(n, v), 0.0);
}

// Interreflection between the walls of a crease takes on their colour.
// source: Jimenez and others, Practical Real-Time Strategies for Accurate Indirect Occlusion, 2016
vec3 colored_occlusion(float ao, vec3 base) {
  vec3 a = 2.0404 * base - 0.3324, b = -4.7951 * base + 0.6417, c = 2.7552 * base + 0.6903;
  return max(vec3(ao), ((ao * a + b) * ao + c) * ao);
}

// GGX with the product of Fresnel and masking fitted for real time.
float specular(vec3 n, vec3 v, vec3 l, float rough) {
  vec3 h = normalize(l + v);
  float nh = max(dot(n, h), 0.0), lh = max(dot(l, h), 0.0);
  float a2 = rough * rough * rough * rough;
  float d = nh * nh * (a2 - 1.0) + 1.00001;
  return a2 / (d * d * max(0.1, lh * lh) * (4.0 * rough * rough + 2.0)) * max(dot(n, l), 0.0);
}

uniform sampler3D skin_detail;  // slope of a rough surface, and its height
uniform float pixel_size;       // of a pixel at distance 1

// Size of a pixel on a surface with this normal, mm.
float pixel_on(vec3 n, vec3 v) { return pixel_size * length(to_eye) / max(dot(n, v), 0.05); }

// The field at a position, at that level of detail.
vec4 detail(vec3 place, float period, float pixel_mm) {
  float level = log2(pixel_mm * float(detail_side) / period);
  return textureLod(skin_detail, place * (1.0 / period), max(level, 0.0)) - 0.5;
}

float fresnel(float nv, float f0) {
  float m = 1.0 - nv;
  float m2 = m * m;
  return f0 + (1.0 - f0) * m2 * m2 * m;
}

// Flat, as a cut face of tissue: the visible inner side where a part is cut.
uniform vec3 cut;          // its colour, linear
uniform vec3 cut_normal;  // unit, towards the removed side
vec3 cut_face(vec3 color) {
  return color * (0.45 + 0.45 * max(dot(cut_normal, key_direction), 0.0)
                + 0.20 * max(dot(cut_normal, normalize(to_eye)), 0.0));
}

// Linear up to 0.72, then a shoulder that preserves the hue; then sRGB.
vec3 display(vec3 c) {
  float peak = max(c.r, max(c.g, c.b));
  const float knee = 0.72, room = 1.0 - knee;
  if (peak > knee) {
    float toned = 1.0 - room * room / (peak + room - knee);
    c *= toned / peak;
    c = mix(c, vec3(toned), 1.0 - 1.0 / (0.25 * (peak - toned) + 1.0));
  }
  c = clamp(c, 0.0, 1.0);
  // Roots take a third of the time of the power 1/2.4; the fit is within 0.02 of 255.
  vec3 s = sqrt(c), q = sqrt(s), e = sqrt(q);
  return mix(12.92 * c, 0.64239 * s + 0.71208 * q - 0.33686 * e - 0.01757 * c, step(0.0031308, c));
}
)";

const char* const surface_source = R"(
uniform float roughness, reflectance, wrap;
uniform vec3 scatter;  // colour of the light transmitted at grazing angles
uniform float coat;    // strength of the second, sharp reflection of wet or enamelled surfaces
uniform vec2 cavity;   // as in the vertex shader
uniform float mapped_up_to;
uniform sampler2D colour_table;
uniform vec2 map_range;
uniform vec3 map_beyond;
uniform float map_lines[4];

// sRGB, only slightly shaded: colours must match those of the legend.
vec3 map_color() {
  float across = fwidth(mapped_value);
  float value = min(mapped_value, mapped_up_to - 1e-4);
  vec3 c = value >= map_range.y ? map_beyond
         : texture(colour_table, vec2((value - map_range.x) / (map_range.y - map_range.x), 0.5)).rgb;
  // No line where the value hardly changes: it would be a blot. Nor where a pixel covers much of
  // its range, as along an outline: it would be a row of dots.
  if (across > 1e-3 && across < 0.04 * (map_range.y - map_range.x))
    for (int i = 0; i < 4; ++i)
      c *= mix(0.25, 1.0, smoothstep(0.6, 1.4, abs(mapped_value - map_lines[i]) / across));
  return c;
}

// Papillae of a tongue; along its middle a furrow, beside that the coating. Smooth mucosa where
// traits.y is 1.
void roughen(vec3 v, inout vec3 n, inout vec3 base, inout float wet) {
  wet = 1.0;
  if (smooth_skin) return;
  float pixel_mm = pixel_on(n, v), rough = 1.0 - traits.y;
  vec4 fine = rough * detail(vec3(rest_place.xy, 0.0), fine_period, pixel_mm);
  vec4 coarse = rough * detail(vec3(rest_place.yx, 0.0), coarse_period, pixel_mm);
  float aside = mod(rest_place.x + 0.5 * rest_period, rest_period) - 0.5 * rest_period
              + 3.0 * coarse.b;
  float furrow = rough * exp(-aside * aside / 2.2), coating = rough * exp(-aside * aside / 90.0);
  vec3 slope = 1.3 * fine.xyy + 0.5 * coarse.yxx + vec3(0.3 * aside * furrow, 0.0, 0.0);
  n = normalize(n - (slope - n * dot(slope, n)));
  base *= 1.0 + vec3(0.25, 0.7, 0.7) * (0.6 * fine.a + 0.4 * coarse.a);
  base = mix(base, vec3(0.62, 0.44, 0.40), 0.3 * coating * (1.0 + coarse.a));
  base *= 1.0 - 0.25 * furrow;
  wet = mix(1.0, clamp(0.4 + 1.2 * fine.a, 0.0, 1.0), rough);
}

void main() {
  begin();
  vec3 v = normalize(to_eye);
  vec3 n = normalize(world_normal);
  if (cuttable && !gl_FrontFacing) {
    result = vec4(display(cut_face(cut)), opacity);
    return;
  }
  // An open surface is lit from its visible side.
  if (!gl_FrontFacing) n = -n;
  vec3 smooth_normal = n, base = albedo;
  float wet = 1.0 - traits.y;
  if (papillae) roughen(v, n, base, wet);
  float nv = clamp(dot(n, v), 0.0, 1.0);
  // Fraction of the pixel covered by the map; 1 where all values are shown.
  float covered = mapped
      ? clamp(0.5 + (mapped_up_to - mapped_value) / max(fwidth(mapped_value), 1e-5), 0.0, 1.0) : 0.0;
  vec4 colored = vec4(0.0);
  if (covered > 0.0) {
    float shade = 0.55 * nv + 0.45 * wrapped(dot(n, key_direction), 0.5);
    float a = seen_through ? 1.0 - pow(1.0 - opacity, 1.0 / max(nv, 0.35)) : 1.0;
    colored = vec4(map_color() * mix(0.68, 1.0, clamp(1.25 * shade, 0.0, 1.0)), a);
    if (covered >= 1.0) {
      result = colored;
      return;
    }
  }
  // interpolation between zero corners may round below 0
  float ao = max(traits.x, 0.0), depth = traits.w;
  float kn = dot(n, key_direction);
  // Grazing light would be shaded by the facets at random: it fades by the angle to the light
  // alone.
  float grazed = smoothstep(-0.05, 0.3, kn);
  float lit = mix(1.0, key_visibility(smooth_normal, grazed > 0.0).x, grazed) * depth;
  vec3 soft = vec3(wrapped(kn, wrap)) + scatter * (wrapped(kn, wrap + 0.45) - wrapped(kn, wrap));
  vec3 occlusion = colored_occlusion(ao * sqrt(ao), base);
  // In the mouth most light is reflected by its red walls.
  if (cavity.y > 0.0) occlusion *= mix(vec3(1.15, 0.80, 0.70), vec3(1.04, 0.95, 0.90), depth);
  vec3 light = key_color * soft * lit * mix(0.55 + 0.45 * ao, 1.0, ao)
             + (fill_color * wrapped(dot(n, fill_direction), wrap + 0.2)
             + rim_color * wrapped(dot(n, rim_direction), 0.0)) * depth * occlusion
             + ambient_light(n, v) * occlusion * depth;
  // Out of their reach light is reflected repeatedly between those walls.
  if (cavity.y > 0.0) light += vec3(0.115, 0.042, 0.037) * (1.0 - depth) * (0.55 + 0.45 * nv);
  float open = ao * ao * depth;
  vec3 shine = key_color * specular(n, v, key_direction, roughness) * lit
             + fill_color * specular(n, v, fill_direction, roughness) * open
             + rim_color * specular(n, v, rim_direction, roughness) * open;
  vec3 c = base * light + reflectance * shine;
  vec3 mirrored = reflect(-v, n);
  // In the mouth grazing reflections point into the dark.
  float around = cavity.y > 0.0 ? open * smoothstep(-1.0, 0.4, dot(mirrored, v)) : open;
  c += ambient_light(mirrored, v) * fresnel(nv, reflectance) * (1.0 - roughness) * around;
  if (coated) {
    // An eye reflects a light lower than the key, which its lid would hide, and the fill as bright
    // as a window: on the iris from the front and from either side.
    bool eye = coat > 0.9;
    vec3 mirrored_key = eye ? normalize(key_direction - 0.35 * sky_direction) : key_direction;
    c += coat * wet * reflectance * (key_color * specular(n, v, mirrored_key, 0.16) * (eye ? sqrt(lit) : lit)
       + fill_color * (eye ? 3.0 : 1.0) * specular(n, v, fill_direction, 0.2) * open);
  }
  float facing = max(dot(smooth_normal, v), 0.35);
  float a = seen_through ? 1.0 - pow(1.0 - opacity, 1.0 / facing) : opacity;
  result = mix(vec4(display(c), a), colored, covered);
}
)";

const char* const mouth_source = R"(
// Offset of the position at rest from another one; stored positions are known up to the period.
vec3 from_rest(vec3 other) {
  return mod(rest_place - other + 0.5 * rest_period, rest_period) - 0.5 * rest_period;
}

uniform vec3 mouth_middle, mouth_half;  // box about the lips at rest, mm
bool beside_mouth() {
  vec3 off = from_rest(mouth_middle) / mouth_half;
  return dot(off, off) < 1.0;
}
)";

const char* const skin_source = R"(
uniform sampler2D skin_table;   // diffuse light by cosine and curvature
uniform float skin_light;  // median linear luminance of the skin's colours
uniform float open_mouth;  // 0 at rest, 1 with the jaw far open

// Fraction of the skin that remains visible towards the cut of the neck.
uniform vec2 neck_end;  // height at rest where it has vanished, mm; 1 / mm over which it does
uniform vec2 neck_sides;  // x of its middle at rest, and half its width, mm; beyond it fades higher up
float visible() {
  if (!vanishing) return 1.0;
  vec3 off = from_rest(vec3(neck_sides.x, 0.0, neck_end.x));
  return smoothstep(0.0, 1.0, (off.z - 0.3 * max(abs(off.x) - neck_sides.y, 0.0)) * neck_end.y);
}

uniform float relief;  // 0 to 1: of pores, furrows and shadows, on skin that is seen through

void main() {
  begin();
  vec3 v = normalize(to_eye);
  vec3 smooth_normal = normalize(world_normal);
  // Where skin folds sharply, as at the corners of an open mouth, the normals of a visible triangle
  // may face away.
  smooth_normal = normalize(smooth_normal - 1.3 * min(dot(smooth_normal, v), 0.0) * v);
  float gloss = traits.z;
  // The lining of the lips was shaded while they were closed.
  float ao = max(traits.x, 0.42 * gloss * open_mouth);
  // Pores and fine creases, and the unevenness under them. Subsurface scattering smooths them: they
  // affect the specular more than the diffuse part.
  float pixel_mm = pixel_on(smooth_normal, v);
  bool furrowed = gloss > 0.15 && beside_mouth();
  // On the red of the lips the cells of skin are long, from lip to lip: furrows.
  float furrows = furrowed ? smoothstep(0.15, 0.4, gloss) : 0.0;
  vec3 cells = furrowed ? lip_cells : vec3(1.0);
  vec4 coarse = smooth_skin ? vec4(0.0) : detail(rest_place.zxy, coarse_period, pixel_mm);
  vec3 bent = vec3(furrowed ? 1.2 * coarse.x : 0.0, 0.0, 0.0);
  vec4 fine = smooth_skin ? vec4(0.0) : detail(rest_place * cells + bent, fine_period, pixel_mm);
  if (seen_through) coarse *= relief, fine *= relief;
  vec3 slope = mix(0.27 - 0.135 * gloss, 1.5 * gloss, furrows) * fine.xyz * cells
             + (0.12 - 0.06 * gloss) * coarse.xyz;
  vec3 n = normalize(smooth_normal - (slope - smooth_normal * dot(slope, smooth_normal)));
  vec3 shine_normal = normalize(mix(smooth_normal, n, 1.6));
  float nv = clamp(dot(n, v), 0.0, 1.0);
  vec3 through = texture(skin_table, vec2(0.5 + 0.5 * dot(n, key_direction), traits.y)).rgb;
  vec2 seen = key_visibility(smooth_normal,
                             through.r > 0.01 || dot(shine_normal, key_direction) > 0.0);
  float lit = seen_through ? mix(1.0, seen.x, relief) : seen.x;
  // Light that enters beside a shadow's edge emerges red inside it, about 2 mm farther.
  vec3 tint = mix(vec3(0.62, 1.0, 1.12), vec3(1.0), clamp(seen.y / 6.0, 0.0, 1.0));
  vec3 tinted = vec3(lit);
  bool dimmed = shadowed && lit > 0.0 && lit < 1.0;
  for (int i = 0; i < (dimmed ? 1 : 0); ++i) tinted = pow(vec3(lit), tint);
  vec3 occlusion = colored_occlusion(ao, albedo);
  const vec3 bleed = vec3(0.42, 0.24, 0.16);
  float fn = dot(n, fill_direction), rn = dot(n, rim_direction);
  vec3 fill = max(vec3(fn) + bleed, 0.0) / ((1.0 + bleed) * (1.0 + bleed));
  vec3 rim = max(vec3(rn) + 0.5 * bleed, 0.0) / ((1.0 + 0.5 * bleed) * (1.0 + 0.5 * bleed));
  float pore = clamp(1.0 + mix(0.55, 0.8, furrows) * fine.a + 0.35 * coarse.a, 0.6, 1.4);
  vec3 light = key_color * through * tinted + (fill_color * fill + rim_color * rim) * occlusion
             + ambient_light(n, v) * occlusion;
  float open = ao * ao;
  float wide = mix(0.50, 0.40, gloss), tight = mix(0.34, 0.22, gloss);
  vec3 shine = key_color * lit * (0.75 * specular(shine_normal, v, key_direction, wide)
                                + 0.25 * specular(shine_normal, v, key_direction, tight))
             + open * (fill_color * specular(shine_normal, v, fill_direction, wide)
                     + rim_color * specular(shine_normal, v, rim_direction, wide));
  shine *= mix(pore * pore, 1.0, gloss);
  float bright = dot(albedo, vec3(0.2126, 0.7152, 0.0722)) / max(skin_light, 1e-4);
  // What is much darker than the skin is taken for hair, which has no broad highlight; what is
  // darker and greyer, for skin with hair cut short.
  float hair = 1.0 - smoothstep(0.2, 0.5, bright);
  float grey = 1.0 - smoothstep(1.7, 2.4, albedo.r / max(albedo.b, 1e-4));
  float stubble = grey * (1.0 - smoothstep(0.6, 1.0, bright));
  shine *= (1.0 - 0.85 * hair * (1.0 - furrows)) * (1.0 - 0.6 * stubble);
  vec3 darker = mix(vec3(0.05, 0.10, 0.12), vec3(0.35, 0.60, 0.60), furrows);
  vec3 tone = mix(vec3(1.0), vec3(pore), darker);
  for (int i = 0; i < (stubble > 0.02 && !smooth_skin ? 1 : 0); ++i) {
    float stubs = detail(2.0 * rest_place.yzx, fine_period, 2.0 * pixel_mm).a;
    tone = mix(tone, vec3(clamp(1.0 + 3.2 * stubs + fine.a + 0.35 * coarse.a, 0.3, 1.5)),
               stubble);
  }
  vec3 c = albedo * tone * light + mix(0.028, 0.05, gloss) * shine;
  c += 0.5 * ambient_light(reflect(-v, n), v) * fresnel(nv, 0.028) * (1.0 - wide) * open;
  vec3 shown = display(c);
  float a = opacity;
  if (seen_through)
    // Above 0, as it hides its inner side.
    a = max(visible() * (1.0 - pow(1.0 - opacity, 1.0 / max(nv, 0.35))), 1.0 / 255.0);
  else if (vanishing)
    shown = mix(backdrop(), shown, visible());
  result = vec4(shown, a);
}
)";

// The mucous side: dark, red and slightly wet; without a shadow map, the darkness is part of the
// colour. Where it is visible through a cut rather than the mouth, it is flesh.
const char* const interior_source = R"(
uniform vec3 eye;
uniform vec4 clip_plane;  // as in the vertex shader
uniform vec4 cut_ball;
uniform float capped;  // 1: where the plane cuts flesh a cap hides this
bool seen_through_a_cut() {
  vec3 offset = cut_ball.xyz - eye;
  float nearest = clamp(-dot(offset, to_eye) / dot(to_eye, to_eye), 0.0, 1.0);
  return distance(offset, -nearest * to_eye) < cut_ball.w
      || (capped == 0.0 && dot(clip_plane, vec4(eye, 1.0)) < 0.0);
}

void main() {
  if (cuttable && seen_through_a_cut()) {
    result = vec4(display(cut_face(cut)), opacity);
    return;
  }
  vec3 v = normalize(to_eye);
  vec3 n = -normalize(world_normal);
  float nv = clamp(dot(n, v), 0.0, 1.0);
  // Mucosa near the lips, dark farther in.
  float depth = traits.w;
  float lit = wrapped(dot(n, key_direction), 0.3) + 0.35;
  vec3 c = mix(vec3(0.060, 0.014, 0.012), vec3(0.235, 0.062, 0.055), depth * depth)
         * (lit * (0.45 + 0.55 * nv));
  c += depth * 0.02 * key_color * specular(n, v, key_direction, 0.3);
  // A triangle that a fold turns over has the normals of the surrounding skin and is shaded like it.
  // The same holds for lips, which fold at the corners of an open mouth.
  float lip = beside_mouth() ? smoothstep(0.15, 0.4, traits.z) : 0.0;
  float turned = mapped ? 0.0 : max(smoothstep(0.0, 0.2, -dot(n, v)), lip);
  vec3 facing = n - 2.0 * min(dot(n, v), 0.0) * v;
  float ao = mix(traits.x, 1.0, lip);  // closed lips shade one another, open ones do not
  vec3 light = 0.7 * key_color * wrapped(dot(facing, key_direction), 0.3) * mix(0.5, 1.0, ao)
             + (fill_color * wrapped(dot(facing, fill_direction), 0.3) + ambient_light(facing, v))
               * colored_occlusion(ao, albedo);
  c = mix(c, albedo * light, turned);
  float a = seen_through ? 1.0 - pow(1.0 - opacity, 1.0 / max(nv, 0.35)) : 1.0;
  result = vec4(display(c), a);
}
)";

// A cut face that closes a solid: a plane.
const char* const cap_source = R"(
void main() { result = vec4(display(cut_face(cut)), 1.0); }
)";

// A ghost of a part, or the edges of its triangles.
const char* const tint_source = R"(
uniform vec3 tint;    // linear
uniform float rim;  // 1: clear in the middle, like glass
uniform float moved;  // 1: visible only in proportion to its displacement (mapped_value, mm)
void main() {
  float nv = abs(dot(normalize(world_normal), normalize(to_eye)));
  float edge = 1.0 - nv;
  result = vec4(display(tint * mix(0.75 + 0.25 * nv, 1.0, 1.0 - rim)),
                opacity * mix(1.0, 0.45 + 0.55 * edge, rim)
                        * mix(1.0, smoothstep(0.5, 2.5, mapped_value), moved));
}
)";

// A muscle: bundles of fibres along it, finer ones between them, each as long as a pixel resolves
// it. Where it is cut its inside has the colour of its surface.
const char* const fibre_source = R"(
float stripes(float at) {
  float across = fwidth(at);
  return sin(6.283185 * at) * (1.0 - smoothstep(0.25, 0.6, across));
}
void main() {
  if (!gl_FrontFacing) {
    result = vec4(display(cut_face(0.8 * albedo)), opacity);
    return;
  }
  vec3 v = normalize(to_eye), n = normalize(world_normal);
  float nv = clamp(dot(n, v), 0.0, 1.0);
  float bundle = stripes(mapped_value), fine = stripes(3.0 * mapped_value + 0.3);
  float groove = 0.6 * bundle + 0.4 * fine;
  vec3 light = key_color * wrapped(dot(n, key_direction), 0.2)
             + fill_color * wrapped(dot(n, fill_direction), 0.2)
             + rim_color * wrapped(dot(n, rim_direction), 0.2) + ambient_light(n, v);
  vec3 c = albedo * (1.0 + 0.22 * groove) * light * mix(0.7, 1.0, nv);
  c += (0.03 + 0.02 * groove) * (key_color * specular(n, v, key_direction, 0.42)
                               + fill_color * specular(n, v, fill_direction, 0.42));
  result = vec4(display(c), opacity);
}
)";

ShaderSource lit(const Shading& shading, const char* own) {
  const std::string start = shading_constants(shading);
  if (shading.deferred)
    return {start + whole_picture_source, start + pixel_source + lighting_source +
                                              shade_offset_source + begin_pixel_source + own};
  return {surface_vertices(), start + triangle_source + lighting_source + own};
}

}  // namespace

ShaderSource cap_shaders() { return lit({}, cap_source); }
ShaderSource tint_shaders() { return lit({}, tint_source); }
ShaderSource fibre_shaders() { return lit({}, fibre_source); }
ShaderSource surface_shaders(const Shading& shading) { return lit(shading, surface_source); }
ShaderSource skin_shaders(const Shading& shading) {
  return lit(shading, (std::string(backdrop_source) + mouth_source + skin_source).c_str());
}
ShaderSource interior_shaders(const Shading& shading) {
  return lit(shading, (std::string(mouth_source) + interior_source).c_str());
}

}  // namespace condyle
