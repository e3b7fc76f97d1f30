#pragma once

#include <future>
#include <memory>

#include "engine/tissue/hessian_factor.h"

namespace condyle {

/// The preconditioner of a sequence of frames, recomputed asynchronously: started at the end of one
/// frame, it is used from a later frame on that its size determines, late enough that frames seldom
/// wait for it. Results therefore do not depend on timing. A value that belongs to the state of
/// a frame: continuing from a copy gives identical frames.
class AsyncPreconditioner {
 public:
  explicit AsyncPreconditioner(std::shared_ptr<const HessianFactor> first)
      : now_(std::move(first)) {}

  const HessianFactor& now() const { return *now_; }
  /// Iterations since the latest factor was started or set.
  int iterations_used() const { return iterations_; }
  void add_iterations(int iterations) { iterations_ += iterations; }
  /// Begins the next frame.
  void advance();
  /// Replaces the factor immediately by one computed within the frame.
  void replace(std::shared_ptr<const HessianFactor> by) {
    now_ = std::move(by);
    iterations_ = 0;
    superseded_ = next_.valid();
  }

  /// Frames from the start of a factorization to its use. `frame_iterations`: of the frames
  /// meanwhile, about; 0: few.
  static int lag(const HessianFactor& factor, int frame_iterations = 0);
  /// Starts the factorisation at state x, for use lag() frames later; ignored while one is pending.
  /// With one thread it is computed when due, or in `finish`. `owner` keeps the mesh alive.
  void begin(const SpringPrismMesh& mesh, MeshLoads loads, Nodes x, int threads,
             std::shared_ptr<const void> owner, int frame_iterations = 0);
  /// Waits for the pending factor, or computes it: for use between frames with a single thread.
  void finish() const {
    if (next_.valid() && !superseded_) next_.wait();
  }

 private:
  std::shared_ptr<const HessianFactor> now_;
  std::shared_future<std::shared_ptr<const HessianFactor>> next_;
  int frames_left_ = 0;
  int iterations_ = 0;
  bool superseded_ = false;  // the pending factor, by a newer one: dropped when due
};

}  // namespace condyle
