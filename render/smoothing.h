#pragma once

#include <memory>

#include "render/drawn_box.h"

namespace condyle {

/// Smooths the stairs at edges of a finished picture (FXAA): a tenth of the cost of multisampling
/// without a GPU.
class EdgeSmoothing {
 public:
  EdgeSmoothing();
  ~EdgeSmoothing();
  EdgeSmoothing(const EdgeSmoothing&) = delete;
  EdgeSmoothing& operator=(const EdgeSmoothing&) = delete;

  /// Draws the texture, smoothed, into the box of the framebuffer that is bound, both width x
  /// height.
  void draw(unsigned texture, int width, int height, const DrawnBox& box);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
