#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "render/scene_renderer.h"

namespace condyle {

/// Draws pictures beside what its owner does. Without a card two threads draw in turn, each with a
/// context and a renderer of its own: while one prepares its picture, the other's is filled. What
/// comes out is the same and in the same order as from one.
class Drawers {
 public:
  /// Draws on one of the threads and gives what is to be done with the picture. That is done in the
  /// order in which pictures were asked for, one at a time.
  using Deliver = std::function<void()>;
  using Draw = std::function<Deliver(SceneRenderer& renderer, int drawer)>;

  /// The parts must outlive it. most: threads at most.
  /// throws: MachineError when there is nothing to draw with.
  explicit Drawers(std::span<const Part> parts, int most = 2);
  /// Draws and delivers what it was given, unless one threw.
  ~Drawers();
  Drawers(const Drawers&) = delete;
  Drawers& operator=(const Drawers&) = delete;

  int count() const;
  /// GL_RENDERER and the EGL platform.
  const std::string& driver() const;
  /// Samples a pixel that the driver gives at most.
  int most_samples() const;
  /// Pixels a side of the largest picture that it draws, supersampling included.
  int most_side() const;

  /// Waits while several others wait. throws: what an earlier picture threw; then those before it
  /// are delivered, none after it, and none is in hand.
  void add(Draw draw);
  /// Waits until all are drawn and delivered. throws: as `add`.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
