#include "render/shaders.h"

namespace condyle {
namespace {

// The products stand exactly as in the surface shaders: with `invariant` the depths agree.
const char* const depth_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 model;
uniform mat4 view_projection;
invariant gl_Position;
void main() {
  vec4 world = model * vec4(position, 1.0);
  gl_Position = view_projection * world;
}
)";

const char* const depth_fragment = R"(#version 330 core
void main() {}
)";

// One triangle over the whole picture, no buffers.
const char* const background_vertex = R"(#version 330 core
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  place = 0.5 + 0.5 * corner;
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

const char* const background_fragment = R"(#version 330 core
in vec2 place;
out vec4 result;
void main() {
  // A pool of light behind the head; half a grey level of ordered noise hides the bands.
  float pool = exp(-2.2 * dot(place - vec2(0.5, 0.48), place - vec2(0.5, 0.48)));
  vec3 c = mix(vec3(0.085, 0.090, 0.100), vec3(0.295, 0.305, 0.325), pool * (0.55 + 0.45 * place.y));
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  int rank = ((cell.x ^ cell.y) & 1) * 8 + (cell.y & 1) * 4
           + (((cell.x ^ cell.y) >> 1) & 1) * 2 + ((cell.y >> 1) & 1);
  result = vec4(c + (float(rank) / 15.0 - 0.5) / 255.0, 1.0);
}
)";

const char* const marker_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 view;
uniform mat4 projection;
uniform float radius;
uniform float pixels_per_unit;  // at distance 1
uniform float nearer;           // toward the eye, so that the ball is not swallowed by its surface
void main() {
  vec4 p = view * vec4(position, 1.0);
  gl_PointSize = max(2.0 * radius * pixels_per_unit / max(-p.z, 1.0), 4.0);
  p.xyz *= 1.0 - nearer / max(length(p.xyz), nearer + 1.0);
  gl_Position = projection * p;
}
)";

const char* const marker_fragment = R"(#version 330 core
uniform float opacity;
out vec4 result;
void main() {
  vec2 q = 2.0 * gl_PointCoord - 1.0;
  float r2 = dot(q, q);
  if (r2 > 1.0) discard;
  vec3 n = vec3(q.x, -q.y, sqrt(1.0 - r2));
  float light = 0.72 + 0.38 * max(dot(n, normalize(vec3(-0.4, 0.6, 0.7))), 0.0);
  // Okabe-Ito vermilion, nearly unlit; a dark rim keeps it apart from red tissue.
  vec3 c = vec3(0.835, 0.369, 0.0) * light * mix(1.0, 0.45, smoothstep(0.7, 1.0, r2));
  result = vec4(c, opacity);
}
)";

}  // namespace

ShaderSource depth_shaders() { return {depth_vertex, depth_fragment}; }
ShaderSource background_shaders() { return {background_vertex, background_fragment}; }
ShaderSource marker_shaders() { return {marker_vertex, marker_fragment}; }

}  // namespace condyle
