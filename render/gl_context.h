#pragma once

#include <memory>
#include <string>

namespace condyle {

/// Whether LIBGL_ALWAYS_SOFTWARE asks Mesa to leave graphics cards alone.
bool no_card_wanted();

/// An OpenGL 3.3 core context with no window and no display, through EGL: hardware devices first
/// (none where LIBGL_ALWAYS_SOFTWARE is set), then the surfaceless platform, then software devices.
/// Current on the thread that made it.
class OffscreenContext {
 public:
  /// throws: MachineError saying what EGL refused and which package to install.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// GL_RENDERER and the EGL platform, for reports; what was tried before it, and why it would not.
  const std::string& description() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
