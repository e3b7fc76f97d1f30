#pragma once

#include <future>
#include <memory>

#include "engine/tissue/hessian_factor.h"

namespace condyle {

/// The preconditioner of a sequence of frames, made anew beside the loop: begun at the end of one
/// frame, it serves from a fixed later frame on, which waits for it if need be. So the bits do not
/// depend on timing. A value that goes with a frame's state: from a copy, frames go on the same way
/// again.
class RollingFactor {
 public:
  explicit RollingFactor(std::shared_ptr<const HessianFactor> first) : now_(std::move(first)) {}

  const HessianFactor& now() const { return *now_; }
  /// Iterations since the newest one was begun or made, of frames told so far.
  int served() const { return served_; }
  void serve(int iterations) { served_ += iterations; }
  /// The next frame has begun.
  void advance();
  /// One made within the frame serves at once.
  void replace(std::shared_ptr<const HessianFactor> by) {
    now_ = std::move(by);
    served_ = 0;
  }

  static constexpr int lag = 1;  // frames
  /// Begins one of state x, to serve `lag` frames later; not while one is being made. With one
  /// thread it is made when it is due, or when `finish` is called. `owner` keeps the net.
  void begin(const SpringPrismNet& net, NetLoads loads, Nodes x, int threads,
             std::shared_ptr<const void> owner);
  /// Waits for the one being made, or makes it: in the time between frames, where there is only one
  /// thread.
  void finish() const {
    if (next_.valid()) next_.wait();
  }

 private:
  std::shared_ptr<const HessianFactor> now_;
  std::shared_future<std::shared_ptr<const HessianFactor>> next_;
  int frames_left_ = 0;
  int served_ = 0;
};

}  // namespace condyle
