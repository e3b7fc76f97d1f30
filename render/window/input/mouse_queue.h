#pragma once

#include <array>
#include <cstddef>
#include <deque>

namespace condyle {

/// Where the mouse is and which buttons are down.
struct MouseMoment {
  double x = -1e6, y = -1e6;
  std::array<bool, 3> down{};        // left, right, middle, as GLFW and ImGui number them
  bool ctrl = false, shift = false;  // held while this button went down
};

/// Presses and releases in their order, each with its own place. On a slow driver a click and the
/// next move arrive within one picture; the panels must still see them one after the other.
class MouseQueue {
 public:
  void moved(double x, double y) {
    now_.x = x;
    now_.y = y;
    // Of several moves in a row only the last matters; a press keeps its place.
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
  /// The next moment, or where the mouse stays when none is waiting.
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
