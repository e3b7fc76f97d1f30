#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/legend.h"
#include "render/scene_renderer.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// The colours of every map of displacement: a fixed range, so that pictures can be compared;
/// nothing goes farther at full opening.
inline ColourMap displacement_map() { return displacement_colours(75); }
inline const std::vector<std::string>& displacement_remarks() {
  static const std::vector<std::string> remarks = {"from rest"};
  return remarks;
}

/// How far each point of the face has come from rest, as colours on it with a legend.
class DisplacementDrawing {
 public:
  /// The parts as they are drawn; the first face is coloured.
  explicit DisplacementDrawing(std::span<const Part> parts);

  /// A frame without a face, or with the face at rest, has none. Gives the renderer the colours.
  void color(SceneRenderer& renderer, const FrameState& frame) const;
  /// The face in its own colours again.
  void clear(SceneRenderer& renderer) const;
  PixelBox add_legend_to(Image& image, Backdrop backdrop) const;

 private:
  ColourMap colours_ = displacement_map();
  Lettering words_;
  std::string name_;  // of the face; empty without one
  std::vector<Eigen::Vector3f> rest_;
};

}  // namespace condyle
