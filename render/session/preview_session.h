#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "render/overlay/overlays.h"
#include "render/session/session_state.h"
#include "sim/session/motion_preview.h"

namespace condyle {

/// Plots and paths of the session's motion, computed in the background and shown as they appear.
class PreviewSession {
 public:
  explicit PreviewSession(SessionState& state)
      : state_(state), job_(state.retired, state.waker()) {}

  /// Starts with another motion; the results of the last one are discarded.
  void restart();
  /// Discards all results; the patient changes.
  void forget();
  /// Called once per turn. `may_start`: no more urgent work is running.
  void update(bool may_start);
  /// The paths of the motion computed so far; none before the first.
  const std::shared_ptr<const LineSet>& paths() const { return paths_; }

 private:
  /// The newest part of a preview, from the thread that computes it.
  struct Post {
    std::mutex mutex;
    std::optional<MotionPreview> preview;
  };
  void start();
  void show(MotionPreview preview);

  SessionState& state_;
  std::shared_ptr<const LineSet> paths_;
  bool due_ = false;
  std::shared_ptr<Post> post_;
  Job<MotionPreview> job_;
};

}  // namespace condyle
