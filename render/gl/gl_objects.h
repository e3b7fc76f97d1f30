#pragma once

#include <epoxy/gl.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <string>
#include <utility>

namespace condyle {

/// Sole owner of one GL name; deleted with the object, while the context is still current.
template <void (*make)(GLuint&), void (*free_name)(GLuint)>
class GlName {
 public:
  GlName() { make(name_); }
  ~GlName() {
    if (name_) free_name(name_);
  }
  GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  operator GLuint() const { return name_; }

 private:
  GLuint name_ = 0;
};

// epoxy's entry points are variables, so they are wrapped before they can be template arguments.
namespace gl {
inline void make_buffer(GLuint& name) { glGenBuffers(1, &name); }
inline void free_buffer(GLuint name) { glDeleteBuffers(1, &name); }
inline void make_array(GLuint& name) { glGenVertexArrays(1, &name); }
inline void free_array(GLuint name) { glDeleteVertexArrays(1, &name); }
inline void make_texture(GLuint& name) { glGenTextures(1, &name); }
inline void free_texture(GLuint name) { glDeleteTextures(1, &name); }
inline void make_sampler(GLuint& name) { glGenSamplers(1, &name); }
inline void free_sampler(GLuint name) { glDeleteSamplers(1, &name); }
inline void make_framebuffer(GLuint& name) { glGenFramebuffers(1, &name); }
inline void free_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
inline void make_renderbuffer(GLuint& name) { glGenRenderbuffers(1, &name); }
inline void free_renderbuffer(GLuint name) { glDeleteRenderbuffers(1, &name); }
}  // namespace gl

using GlBuffer = GlName<gl::make_buffer, gl::free_buffer>;
using GlVertexArray = GlName<gl::make_array, gl::free_array>;
using GlTexture = GlName<gl::make_texture, gl::free_texture>;
using GlSampler = GlName<gl::make_sampler, gl::free_sampler>;
using GlFramebuffer = GlName<gl::make_framebuffer, gl::free_framebuffer>;
using GlRenderbuffer = GlName<gl::make_renderbuffer, gl::free_renderbuffer>;

struct ShaderSource;

/// A linked pair of shaders. Setting a uniform that the compiler dropped does nothing.
class GlProgram {
 public:
  /// throws: MachineError with the driver's message when the shaders do not compile or link.
  GlProgram(const char* what, const ShaderSource& source);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void use() const;
  // Uniforms of the program in use:
  void set(const char* uniform, int value);
  void set(const char* uniform, float value);
  void set(const char* uniform, const Eigen::Vector2i& value);
  void set(const char* uniform, const Eigen::Vector2f& value);
  void set(const char* uniform, const Eigen::Vector3f& value);
  void set(const char* uniform, const Eigen::Vector4f& value);
  void set(const char* uniform, const Eigen::Matrix4f& value);

 private:
  GLint location(const char* uniform);
  GLuint program_ = 0;
  std::map<std::string, GLint, std::less<>> places_;
};

/// GL_RENDERER of the current context.
std::string renderer_name();
/// Whether the current context draws without a graphics card.
bool draws_in_software();

}  // namespace condyle
