#include "render/scene/background.h"

#include "render/gl/framebuffer.h"
#include "render/shaders/shaders.h"

namespace condyle {

Background::Background() : program_("background", background_shaders()) {}

void Background::set_in(GlProgram& program, int width, int height, Backdrop shade) {
  program.set("pixel",
              Eigen::Vector2f(1 / static_cast<float>(width), 1 / static_cast<float>(height)));
  program.set("light", shade == Backdrop::light ? 1 : 0);
}

void Background::draw(int width, int height, Backdrop shade) {
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glDisable(GL_CULL_FACE);
  program_.use();
  set_in(program_, width, height, shade);
  glBindVertexArray(no_attributes_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
}

const std::vector<std::uint8_t>& Background::picture(int width, int height, Backdrop shade) {
  if (width == width_ && height == height_ && shade == shade_) return picture_;
  GLint before = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
  const Framebuffer target(width, height, 1);
  target.bind();
  for (const GLenum off : {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_DEPTH_TEST})
    glDisable(off);
  draw(width, height, shade);
  picture_.resize(std::size_t{4} * static_cast<std::size_t>(width) *
                  static_cast<std::size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, picture_.data());
  glBindVertexArray(0);
  glUseProgram(0);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
  width_ = width;
  height_ = height;
  shade_ = shade;
  return picture_;
}

}  // namespace condyle
