#include "render/smoothing.h"

#include "render/gl_objects.h"

namespace condyle {
namespace {

const char* const vertex = R"(#version 330 core
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";

// Lottes' FXAA in its short form: where brightness changes, blur along the edge, and keep the
// longer blur only if it stays between the neighbours.
const char* const fragment = R"(#version 330 core
uniform sampler2D picture;
uniform vec2 pixel;
out vec4 result;
float luma(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }
void main() {
  vec2 at = gl_FragCoord.xy * pixel;
  vec4 own = texture(picture, at);
  vec3 middle = own.rgb;
  float nw = luma(texture(picture, at + vec2(-0.5, 0.5) * pixel).rgb);
  float ne = luma(texture(picture, at + vec2(0.5, 0.5) * pixel).rgb);
  float sw = luma(texture(picture, at + vec2(-0.5, -0.5) * pixel).rgb);
  float se = luma(texture(picture, at + vec2(0.5, -0.5) * pixel).rgb);
  float m = luma(middle);
  float low = min(m, min(min(nw, ne), min(sw, se)));
  float high = max(m, max(max(nw, ne), max(sw, se)));
  result = own;
  if (high - low < max(0.03, 0.1 * high)) return;
  vec2 edge = vec2((sw + se) - (nw + ne), (nw + sw) - (ne + se));
  float shorten = 1.0 / (min(abs(edge.x), abs(edge.y)) + max(0.03 * (nw + ne + sw + se), 0.008));
  edge = clamp(edge * shorten, -6.0, 6.0) * pixel;
  vec4 near = 0.5 * (texture(picture, at - edge / 6.0) + texture(picture, at + edge / 6.0));
  vec4 far = 0.5 * near +
             0.25 * (texture(picture, at - 0.5 * edge) + texture(picture, at + 0.5 * edge));
  float f = luma(far.rgb);
  result = f < low || f > high ? near : far;
}
)";

}  // namespace

struct EdgeSmoothing::State {
  GlProgram program{"edge smoothing", vertex, fragment};
  GlVertexArray nothing;  // a core context draws nothing without one
};

EdgeSmoothing::EdgeSmoothing() : state_(std::make_unique<State>()) {}
EdgeSmoothing::~EdgeSmoothing() = default;

void EdgeSmoothing::draw(unsigned texture, int width, int height, const DrawnBox& box) {
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glViewport(0, 0, width, height);
  glEnable(GL_SCISSOR_TEST);
  glScissor(box.x0, box.y0, box.width(), box.height());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture);
  state_->program.use();
  state_->program.set("picture", 0);
  state_->program.set("pixel", Eigen::Vector2f(1.0f / static_cast<float>(width),
                                               1.0f / static_cast<float>(height)));
  glBindVertexArray(state_->nothing);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_SCISSOR_TEST);
  glBindVertexArray(0);
  glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace condyle
