#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "render/overlay/overlays.h"
#include "render/session/session_state.h"
#include "sim/session/motion_preview.h"

namespace condyle {

/// Plots and paths of the session's motion, made beside it and shown as far as they are known.
class PreviewSession {
 public:
  explicit PreviewSession(SessionState& state)
      : state_(state), job_(state.retired, state.waker()) {}

  /// Another motion: what was known of the last one is dropped.
  void restart();
  /// Another patient.
  void forget();
  /// Once a turn. `may_start`: nothing more urgent is at work.
  void update(bool may_start);
  /// Of the motion, as far as they are known; none before.
  const std::shared_ptr<const LineSet>& paths() const { return paths_; }

 private:
  /// The newest part of a preview, from the thread that makes it.
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
