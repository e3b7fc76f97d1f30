#include "render/gl/gl_context.h"

#include <epoxy/egl.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <vector>

#include "engine/core/error.h"
#include "render/gl/gl_objects.h"

namespace condyle {
namespace {

constexpr EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                         3,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         3,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};

struct Candidate {
  EGLenum platform;
  void* device;
  std::string name;
  int contexts = 0;  // of this process on its display
};

/// Number of this process's contexts on each display.
class DisplayUse {
 public:
  void add(EGLDisplay display, int change) {
    const std::lock_guard lock(mutex_);
    contexts_[display] += change;
  }
  int contexts(EGLDisplay display) {
    const std::lock_guard lock(mutex_);
    return contexts_[display];
  }

 private:
  std::mutex mutex_;
  std::map<EGLDisplay, int> contexts_;
};

DisplayUse& display_use() {
  static DisplayUse use;
  return use;
}

EGLDisplay display_of(const Candidate& candidate) {
  return eglGetPlatformDisplayEXT(candidate.platform, candidate.device, nullptr);
}

/// eglGetString of the client extensions, which exists before any display. On some versions epoxy's
/// own query needs a display.
bool client_extension(const char* name) {
  const char* all = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return all && std::strstr(all, name);
}

/// Hardware devices, then the surfaceless platform, then software devices. Of the last two, the one
/// with the fewest contexts comes first: Mesa's software renderer (22.3) reads the memory of all
/// contexts of a display from each of them, without a lock, and crashes where two draw at a time.
std::vector<Candidate> candidates() {
  std::vector<Candidate> hardware, software;
  if (client_extension("EGL_EXT_platform_device") &&
      (client_extension("EGL_EXT_device_enumeration") || client_extension("EGL_EXT_device_base"))) {
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    if (eglQueryDevicesEXT(16, devices, &count))
      for (EGLint i = 0; i < count; ++i) {
        const char* about =
            client_extension("EGL_EXT_device_query") || client_extension("EGL_EXT_device_base")
                ? eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS)
                : nullptr;
        const bool soft = about && std::strstr(about, "EGL_MESA_device_software");
        auto& list = soft ? software : hardware;
        // Mesa renders on a graphics card that is chosen as a device, even if software was
        // requested.
        if (!soft && software_gl_requested()) continue;
        list.push_back({EGL_PLATFORM_DEVICE_EXT, devices[i],
                        std::string(soft ? "software" : "hardware") + " device"});
      }
  }
  std::vector<Candidate> all = hardware;
  if (client_extension("EGL_MESA_platform_surfaceless"))
    all.push_back({EGL_PLATFORM_SURFACELESS_MESA, nullptr, "surfaceless"});
  all.insert(all.end(), software.begin(), software.end());
  for (Candidate& candidate : all)
    candidate.contexts = display_use().contexts(display_of(candidate));
  std::stable_sort(all.begin() + std::ssize(hardware), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.contexts < b.contexts; });
  return all;
}

std::string egl_error() {
  switch (const EGLint error = eglGetError()) {
    case EGL_NOT_INITIALIZED:
      return "not initialised";
    case EGL_BAD_ALLOC:
      return "out of resources";
    case EGL_BAD_MATCH:
      return "OpenGL 3.3 core is not available";
    case EGL_BAD_ATTRIBUTE:
      return "an attribute is unknown";
    default:
      return "EGL error " + std::to_string(error);
  }
}

}  // namespace

bool software_gl_requested() {
  const char* value = std::getenv("LIBGL_ALWAYS_SOFTWARE");
  return value && *value && !std::strchr("0nNfF", *value);
}

struct OffscreenContext::State {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::string description;

  ~State() {
    if (context != EGL_NO_CONTEXT) {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(display, context);
      display_use().add(display, -1);
    }
    // Displays are shared by the whole process: terminating one would destroy another's context.
  }

  /// Makes the context current, or returns the reason for the failure.
  std::string start(const Candidate& candidate) {
    display = display_of(candidate);
    if (display == EGL_NO_DISPLAY) return "no display (" + egl_error() + ")";
    if (!eglInitialize(display, nullptr, nullptr)) return "cannot start (" + egl_error() + ")";
    if (!epoxy_has_egl_extension(display, "EGL_KHR_no_config_context"))
      return "contexts without a configuration are not available";
    if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context"))
      return "contexts without a surface are not available";
    if (!eglBindAPI(EGL_OPENGL_API)) return "OpenGL is not available";
    context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, context_attributes);
    if (context == EGL_NO_CONTEXT) return "no context (" + egl_error() + ")";
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
      const std::string reason = egl_error();
      eglDestroyContext(display, context);
      context = EGL_NO_CONTEXT;
      return "the context cannot be used (" + reason + ")";
    }
    display_use().add(display, 1);
    return {};
  }
};

OffscreenContext::OffscreenContext() : state_(std::make_unique<State>()) {
  std::string refusals;
  if (epoxy_has_egl())
    for (const auto& candidate : candidates()) {
      const std::string refusal = state_->start(candidate);
      if (refusal.empty()) {
        state_->description = renderer_name() + ", EGL " + candidate.name;
        if (!refusals.empty()) state_->description += "; not " + refusals;
        return;
      }
      refusals += (refusals.empty() ? "" : "; ") + candidate.name + ": " + refusal;
    }
  if (refusals.empty()) refusals = "no EGL library or no platform without a display";
  throw MachineError("pictures cannot be drawn: EGL provides no OpenGL 3.3 context (" + refusals +
                     "); install libegl1, libgl1 and libgl1-mesa-dri");
}

OffscreenContext::~OffscreenContext() = default;

const std::string& OffscreenContext::description() const { return state_->description; }

bool OffscreenContext::shares_display() const {
  return display_use().contexts(state_->display) > 1;
}

}  // namespace condyle
