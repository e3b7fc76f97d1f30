#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "render/scene/scene_renderer.h"

namespace condyle {

/// Draws pictures concurrently with its owner. Without a graphics card two threads draw in turn,
/// each with its own context and renderer: while one prepares its picture, the other's is
/// rasterised. Results and their order are the same as with one. One thread draws where other
/// contexts of the process leave no display for a second (see OffscreenContext::shares_display).
class ParallelRenderers {
 public:
  /// Draws on one of the threads and returns the action that delivers the picture. Actions are
  /// executed one at a time in the order in which pictures were requested.
  using Deliver = std::function<void()>;
  using Draw = std::function<Deliver(SceneRenderer& renderer, int drawer)>;

  /// The parts must outlive it. most: maximum number of threads. operation: see SceneRenderer.
  /// throws: MachineError when nothing can draw.
  explicit ParallelRenderers(std::span<const Part> parts, int most = 2,
                             std::shared_ptr<const BeforeOperation> operation = {});
  /// Draws and delivers all submitted pictures, unless one threw.
  ~ParallelRenderers();
  ParallelRenderers(const ParallelRenderers&) = delete;
  ParallelRenderers& operator=(const ParallelRenderers&) = delete;

  int count() const;
  /// GL_RENDERER and the EGL platform.
  const std::string& driver() const;
  /// Maximum number of samples per pixel that the driver provides.
  int max_samples() const;
  /// Largest picture that it draws, pixels per side, supersampling included.
  int max_side() const;

  /// Blocks while several pictures are waiting. throws: the error of an earlier picture; then those
  /// before it have been delivered, none after it, and none is being drawn.
  void add(Draw draw);
  /// Waits until all are drawn and delivered. throws: as `add`.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
