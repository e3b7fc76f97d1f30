#include "render/shaders/shader_parts.h"
#include "render/shaders/shaders.h"

namespace condyle {

// One triangle over the whole picture, no buffers.
const char* const whole_picture_source = R"(
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";

// Inputs of lighting, from the stored data of a pixel (see surface_buffer.h).
const char* const pixel_source = R"(
vec3 to_eye;
vec3 world_normal;
vec3 albedo;
vec3 shadow_place;
vec4 traits;
vec3 rest_place;
const float mapped_value = 0.0;
void begin();
)";

const char* const begin_pixel_source = R"(
uniform usampler2D kept_words;
uniform sampler2D kept_away;
uniform vec3 eye, ray, ray_right, ray_up;  // from the eye to a pixel's point at unit distance
uniform float two_sided;
vec4 four(uint word) {
  return vec4(word & 0xffu, (word >> 8u) & 0xffu, (word >> 16u) & 0xffu, word >> 24u)
       * (1.0 / 255.0);
}
void begin() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  uvec4 words = texelFetch(kept_words, pixel, 0);
  vec2 folded = vec2(words.x & 0xffffu, words.x >> 16u) * (2.0 / 65535.0) - 1.0;
  vec3 n = vec3(folded, 1.0 - abs(folded.x) - abs(folded.y));
  float back = max(-n.z, 0.0);
  n.xy += vec2(n.x < 0.0 ? back : -back, n.y < 0.0 ? back : -back);
  world_normal = normalize(n);
  vec4 colored = four(words.y), last = four(words.w);
  albedo = colored.rgb * colored.rgb;
  vec3 place = vec3(words.z & 0xffffu, words.z >> 16u, words.w & 0xffffu) * (1.0 / 65535.0);
  rest_place = rest_period * place;
  traits = vec4(colored.a, last.zw, place.z);
  to_eye = -texelFetch(kept_away, pixel, 0).r
         * (ray + gl_FragCoord.x * ray_right + gl_FragCoord.y * ray_up);
  shadow_place = (shadow_matrix * vec4(eye - to_eye + shade_offset(world_normal, key_direction,
                                                                   to_eye, two_sided, traits.z),
                                     1.0)).xyz;
}
)";

namespace {

// Four 32-bit values per pixel: the normal, in octahedral encoding; colour (square roots) and
// occlusion; two of the rest position; the third, curvature and gloss. For all surfaces but skin
// the third is the depth in the mouth; of those only tongues have the first two. source: Meyer and
// others, On Floating-Point Normal Vectors, 2010 (octahedron)
const char* const keep_source = R"(
in vec3 world_normal;
in vec3 albedo;
in vec4 traits;
in vec3 rest_place;
layout(location = 0) out uvec4 words;
layout(location = 1) out float away;  // distance from the eye, mm
uint pair(vec2 v) {
  uvec2 u = uvec2(clamp(v, 0.0, 1.0) * 65535.0 + 0.5);
  return u.x | (u.y << 16u);
}
uint four(vec4 v) {
  uvec4 u = uvec4(clamp(v, 0.0, 1.0) * 255.0 + 0.5);
  return u.x | (u.y << 8u) | (u.z << 16u) | (u.w << 24u);
}
void main() {
  // An open surface is lit from its visible side.
  vec3 n = gl_FrontFacing ? world_normal : -world_normal;
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 folded = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  vec3 place = fract(rest_place * (1.0 / rest_period));
  if (!skin) place.z = traits.w;
  uint low = uint(clamp(place.z, 0.0, 1.0) * 65535.0 + 0.5);
  words = uvec4(pair(0.5 + 0.5 * (n.z < 0.0 ? folded : n.xy)),
                four(vec4(sqrt(albedo), traits.x)), pair(place.xy),
                low | (four(vec4(0.0, 0.0, traits.yz)) & 0xffff0000u));
  away = 1.0 / gl_FragCoord.w;
}
)";

// Resolves a surface lit per pixel into a multisampled picture: where another surface covers the
// pixel's centre, the light of the neighbour of the same surface nearest in depth, else of any
// neighbour. Surfaces in contact are distinguished by their numbers. A sliver that covers no
// neighbouring centre is omitted.
const char* const carry_source = R"(
uniform sampler2D kept_away, lit;
uniform ivec2 last_pixel;
uniform float number;  // of this surface, over 255
out vec4 result;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float own = 1.0 / gl_FragCoord.w, off = abs(texelFetch(kept_away, pixel, 0).r - own);
  vec4 light = texelFetch(lit, pixel, 0);
  const float none = 1e30;
  bool same = abs(light.a - number) < 0.001;
  bool other = !same || off > fwidth(own) + 0.02;
  float foreign = same ? none : off;
  if (!same) off = none;
  vec4 foreign_light = light;
  for (int i = 0; i < (other ? 9 : 0); ++i) {
    ivec2 there = clamp(pixel + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last_pixel);
    vec4 found = texelFetch(lit, there, 0);
    float d = abs(texelFetch(kept_away, there, 0).r - own);
    if (abs(found.a - number) < 0.001) {
      if (d < off) {
        off = d;
        light = found;
      }
    } else if (d < foreign) {
      foreign = d;
      foreign_light = found;
    }
  }
  if (off > 1e20) {
    if (foreign > 1e20) discard;
    light = foreign_light;
  }
  result = vec4(light.rgb, 1.0);
}
)";

// The same for pictures with one sample per pixel: all surfaces at once, before the backdrop.
const char* const place_source = R"(
uniform sampler2D kept_depth, lit;
uniform float behind;  // opacity of the backdrop
out vec4 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(kept_depth, at, 0).r;
  gl_FragDepth = depth;
  result = depth < 1.0 ? vec4(texelFetch(lit, at, 0).rgb, 1.0) : behind * vec4(backdrop(), 1.0);
}
)";

// Blends a translucent surface, in pictures with one sample per pixel. Pixels that it does not
// cover have opacity 0.
const char* const blend_source = R"(
uniform sampler2D kept_depth, lit;
out vec4 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  result = texelFetch(lit, at, 0);
  if (result.a == 0.0) discard;
  gl_FragDepth = texelFetch(kept_depth, at, 0).r;
}
)";

// Marks the pixels in which surfaces may have an edge: where neighbours belong to another one, or
// depth is not steady.
const char* const edge_source = R"(
uniform sampler2D kept_away, lit;
uniform ivec2 last_pixel;
out float marked;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float own = texelFetch(kept_away, pixel, 0).r, number = texelFetch(lit, pixel, 0).a;
  const float none = 1e20;
  bool edge = false;
  for (int i = 0; i < 2; ++i) {
    ivec2 off = ivec2(i, 1 - i);
    ivec2 there = min(pixel + off, last_pixel), back = max(pixel - off, ivec2(0));
    float a = texelFetch(kept_away, there, 0).r, b = texelFetch(kept_away, back, 0).r;
    float other = max(abs(texelFetch(lit, there, 0).a - number),
                      abs(texelFetch(lit, back, 0).a - number));
    edge = edge || (own > none ? min(a, b) < none
                               : abs(a + b - 2.0 * own) > 0.03 + 0.2 * abs(a - b) || other > 0.001);
  }
  marked = edge ? 1.0 : 0.0;
}
)";

// For pictures with several samples per pixel: all samples of a pixel without edges have its light.
const char* const inner_source = R"(
uniform sampler2D kept_depth, kept_away, lit, edges;
out vec4 result;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (texelFetch(edges, pixel, 0).r > 0.0 || texelFetch(kept_away, pixel, 0).r > 1e20) discard;
  gl_FragDepth = texelFetch(kept_depth, pixel, 0).r;
  result = vec4(texelFetch(lit, pixel, 0).rgb, 1.0);
}
)";

}  // namespace

ShaderSource keep_shaders(const Shading& shading) {
  return {surface_vertices(), shading_constants(shading) + keep_source};
}
ShaderSource carry_shaders() { return {surface_vertices(), shading_constants({}) + carry_source}; }
ShaderSource place_shaders() {
  return {shading_constants({}) + whole_picture_source,
          shading_constants({}) + backdrop_source + place_source};
}
ShaderSource blend_shaders() {
  return {shading_constants({}) + whole_picture_source, shading_constants({}) + blend_source};
}
ShaderSource edge_shaders() {
  return {shading_constants({}) + whole_picture_source, shading_constants({}) + edge_source};
}
ShaderSource inner_shaders() {
  return {shading_constants({}) + whole_picture_source, shading_constants({}) + inner_source};
}

}  // namespace condyle
