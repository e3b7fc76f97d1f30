#pragma once

#include <memory>
#include <string>

namespace condyle {

/// An OpenGL 3.3 core context with no window and no display, through EGL: the surfaceless platform,
/// then the device platform (a hardware device first). Current on the thread that made it.
class OffscreenContext {
 public:
  /// throws: MachineError saying what EGL refused and which package to install.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// GL_RENDERER and the EGL platform, for reports.
  const std::string& description() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
