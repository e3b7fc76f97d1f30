#include "render/gl/gl_objects.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "engine/core/error.h"
#include "render/shaders/shaders.h"

namespace condyle {
namespace {

constexpr const char* software_renderers[] = {"llvmpipe", "softpipe", "swrast", "SWR"};

GLuint compile(const char* what, GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (!good) {
    char log[2000] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    glDeleteShader(shader);
    throw MachineError(std::string("the graphics driver refuses the shader '") + what +
                       "': " + log);
  }
  return shader;
}

}  // namespace

GlProgram::GlProgram(const char* what, const ShaderSource& source) {
  const GLuint first = compile(what, GL_VERTEX_SHADER, source.vertex);
  GLuint second = 0;
  try {
    second = compile(what, GL_FRAGMENT_SHADER, source.fragment);
  } catch (...) {
    glDeleteShader(first);
    throw;
  }
  program_ = glCreateProgram();
  glAttachShader(program_, first);
  glAttachShader(program_, second);
  glLinkProgram(program_);
  glDeleteShader(first);
  glDeleteShader(second);
  GLint good = GL_FALSE;
  glGetProgramiv(program_, GL_LINK_STATUS, &good);
  if (!good) {
    char log[2000] = "";
    glGetProgramInfoLog(program_, sizeof log, nullptr, log);
    glDeleteProgram(program_);
    throw MachineError(std::string("the graphics driver cannot link the shader '") + what +
                       "': " + log);
  }
}

GlProgram::~GlProgram() { glDeleteProgram(program_); }

void GlProgram::use() const { glUseProgram(program_); }

GLint GlProgram::location(const char* uniform) {
  auto found = places_.find(uniform);
  if (found == places_.end())
    found = places_.emplace(uniform, glGetUniformLocation(program_, uniform)).first;
  return found->second;
}

void GlProgram::set(const char* uniform, int value) { glUniform1i(location(uniform), value); }
void GlProgram::set(const char* uniform, float value) { glUniform1f(location(uniform), value); }
void GlProgram::set(const char* uniform, const Eigen::Vector2i& value) {
  glUniform2iv(location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Vector2f& value) {
  glUniform2fv(location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Vector3f& value) {
  glUniform3fv(location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Vector4f& value) {
  glUniform4fv(location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());
}

std::string renderer_name() {
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return name ? name : "unknown driver";
}

bool draws_in_software() {
  const std::string name = renderer_name();
  return std::any_of(std::begin(software_renderers), std::end(software_renderers),
                     [&](const char* of) { return name.find(of) != std::string::npos; });
}

}  // namespace condyle
