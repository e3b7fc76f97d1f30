#include <string>

#include "render/shaders/shader_parts.h"
#include "render/shaders/shaders.h"

namespace condyle {
namespace {

// The products are the same as in the surface shaders: with `invariant` the depths agree.
const char* const depth_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 model;
uniform mat4 view_projection;
uniform vec4 clip_plane;
uniform vec4 cut_ball;
out float gl_ClipDistance[2];
invariant gl_Position;
void main() {
  vec4 world = model * vec4(position, 1.0);
  gl_Position = view_projection * world;
  gl_ClipDistance[0] = dot(clip_plane, world);
  gl_ClipDistance[1] = distance(world.xyz, cut_ball.xyz) - cut_ball.w;
}
)";

const char* const depth_fragment = R"(#version 330 core
void main() {}
)";

// One triangle over the whole picture, without buffers; at the far plane, so that only empty pixels
// are shaded.
const char* const background_vertex = R"(#version 330 core
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 1.0, 1.0);
}
)";

const char* const background_fragment = R"(
out vec4 result;
void main() { result = vec4(backdrop(), 1.0); }
)";

const char* const marker_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 view;
uniform mat4 projection;
uniform float radius;
uniform float pixels_per_unit;  // at distance 1
uniform float nearer;  // towards the eye, so that the ball does not sink into its surface
void main() {
  vec4 p = view * vec4(position, 1.0);
  gl_PointSize = max(2.0 * radius * pixels_per_unit / max(-p.z, 1.0), 4.0);
  p.xyz *= 1.0 - nearer / max(length(p.xyz), nearer + 1.0);
  gl_Position = projection * p;
}
)";

const char* const marker_fragment = R"(#version 330 core
uniform float opacity;
uniform vec3 color;
out vec4 result;
void main() {
  vec2 q = 2.0 * gl_PointCoord - 1.0;
  float r2 = dot(q, q);
  if (r2 > 1.0) discard;
  vec3 n = vec3(q.x, -q.y, sqrt(1.0 - r2));
  float light = 0.72 + 0.38 * max(dot(n, normalize(vec3(-0.4, 0.6, 0.7))), 0.0);
  // Nearly unlit; a dark rim separates it from red tissue.
  vec3 c = color * light * mix(1.0, 0.45, smoothstep(0.7, 1.0, r2));
  result = vec4(c, opacity);
}
)";

// Each line is the four corners of a strip along it, of a given width on the screen.
const char* const line_vertex = R"(#version 330 core
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec3 color;
uniform mat4 view;
uniform mat4 projection;
uniform vec2 half_picture;  // pixels
uniform float half_width;   // pixels
uniform float border;       // pixels, around the line
uniform float near;  // mm in front of the eye
// fraction of the distance to the eye, so that a line does not sink into a surface
uniform float nearer;
out vec3 line_color;
out float across;
void main() {
  vec3 a = (view * vec4(from, 1.0)).xyz, b = (view * vec4(to, 1.0)).xyz;
  // Points behind the eye cannot be projected: the line ends in front of it.
  if (a.z > -near && b.z < -near) a = mix(a, b, (a.z + near) / (a.z - b.z));
  if (b.z > -near && a.z < -near) b = mix(b, a, (b.z + near) / (b.z - a.z));
  vec4 p = projection * vec4(a * (1.0 - nearer), 1.0), q = projection * vec4(b * (1.0 - nearer), 1.0);
  vec2 along = (q.xy / q.w - p.xy / p.w) * half_picture;
  along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
  vec4 end = (gl_VertexID & 1) == 0 ? p : q;
  float side = (gl_VertexID & 2) == 0 ? -1.0 : 1.0;
  float w = half_width + border + 0.7;  // margin for a soft edge
  vec2 shift = side * w * vec2(-along.y, along.x) / half_picture;
  end.xy += shift * end.w;
  if (a.z > -near && b.z > -near) end = vec4(2.0, 2.0, 2.0, 1.0);
  gl_Position = end;
  across = side * w;
  line_color = pow(color, vec3(2.2));
}
)";

const char* const line_fragment = R"(#version 330 core
in vec3 line_color;
in float across;
uniform float opacity, half_width, border;
out vec4 result;
void main() {
  float cover = clamp(half_width + 0.5 - abs(across), 0.0, 1.0);
  result = vec4(pow(line_color, vec3(1.0 / 2.2)), opacity * cover);
  if (border > 0.0) {
    float around = clamp(half_width + border + 0.5 - abs(across), 0.0, 1.0);
    result = vec4(mix(vec3(0.10, 0.11, 0.13), result.rgb, cover), opacity * around);
  }
}
)";

}  // namespace

ShaderSource line_shaders() { return {line_vertex, line_fragment}; }
ShaderSource depth_shaders() { return {depth_vertex, depth_fragment}; }
ShaderSource background_shaders() {
  return {background_vertex,
          std::string("#version 330 core\n") + backdrop_source + background_fragment};
}
ShaderSource marker_shaders() { return {marker_vertex, marker_fragment}; }

}  // namespace condyle
