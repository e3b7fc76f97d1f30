#pragma once

#include <array>
#include <cstddef>
#include <deque>

namespace condyle {

/// Position of the mouse and state of its buttons.
struct MouseMoment {
  double x = -1e6, y = -1e6;
  std::array<bool, 3> down{};        // left, right, middle, as GLFW and ImGui number them
  bool ctrl = false, shift = false;  // held while this button went down
};

/// Presses and releases in order, each with its position. On a slow driver a click and the next
/// move arrive within one picture; the panels must still receive them one after the other.
class MouseQueue {
 public:
  void moved(double x, double y) {
    now_.x = x;
    now_.y = y;
    // Only the last of successive moves counts; a press keeps its position.
    if (moved_last_ && !moments_.empty())
      moments_.back() = now_;
    else
      moments_.push_back(now_);
    moved_last_ = true;
  }
  void pressed(int button, bool down, bool ctrl = false, bool shift = false) {
    if (button < 0 || button >= 3) return;
    now_.down[static_cast<std::size_t>(button)] = down;
    moments_.push_back(now_);
    moments_.back().ctrl = down && ctrl;
    moments_.back().shift = down && shift;
    moved_last_ = false;
  }
  bool waiting() const { return !moments_.empty(); }
  /// The next event, or the last position when none is waiting.
  MouseMoment take() {
    if (moments_.empty()) return now_;
    const MouseMoment next = moments_.front();
    moments_.pop_front();
    return next;
  }
  const MouseMoment& now() const { return now_; }

 private:
  MouseMoment now_;
  bool moved_last_ = false;
  std::deque<MouseMoment> moments_;
};

}  // namespace condyle
