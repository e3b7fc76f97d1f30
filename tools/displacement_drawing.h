#pragma once

#include <string>

#include "render/legend.h"
#include "render/scene_renderer.h"
#include "sim/case/case.h"
#include "sim/frame/frame_state.h"

namespace condyle {

/// How far each point of the face has come from rest, as colours on it with a legend.
class DisplacementDrawing {
 public:
  DisplacementDrawing(const Case& patient, double most_mm, SceneRenderer& renderer);

  /// A frame without a face, or with the face at rest, has none.
  void color(SceneRenderer& renderer, const FrameState& frame) const;
  /// The face in its own colours again.
  void clear(SceneRenderer& renderer) const;
  void add_legend_to(Image& image) const { add_legend(image, words_, colours_, {"from rest"}); }

 private:
  ColourMap colours_;
  Lettering words_;
  std::string name_;  // of the face; empty without one
  std::vector<Eigen::Vector3f> rest_;
};

}  // namespace condyle
