#pragma once

#include <memory>
#include <string>

namespace condyle {

/// Whether LIBGL_ALWAYS_SOFTWARE requests Mesa's software renderer.
bool software_gl_requested();

/// An OpenGL 3.3 core context without window or display, through EGL: hardware devices first (none
/// where LIBGL_ALWAYS_SOFTWARE is set), then the surfaceless platform and software devices, the one
/// that fewer contexts use first. Current on the thread that created it.
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

  /// Whether another context of this process uses its display. Two that do must not draw at the
  /// same time in software: Mesa 22.3 crashes.
  bool shares_display() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
