#pragma once

#include <memory>
#include <string>

namespace condyle {

/// Whether LIBGL_ALWAYS_SOFTWARE requests Mesa's software renderer.
bool software_gl_requested();

/// An OpenGL 3.3 core context without window or display, through EGL: hardware devices first (none
/// where LIBGL_ALWAYS_SOFTWARE is set), then the surfaceless platform, then software devices.
/// Current on the thread that created it.
class OffscreenContext {
 public:
  /// throws: MachineError with EGL's reasons and the packages to install.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// GL_RENDERER and the EGL platform, for reports; the platforms tried before, and why they
  /// failed.
  const std::string& description() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
