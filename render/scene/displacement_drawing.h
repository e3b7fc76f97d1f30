#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/overlay/legend.h"
#include "render/scene/scene_renderer.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// The colours of every displacement map: a fixed range, so that pictures can be compared; it
/// exceeds all displacements at full opening.
inline ColourMap displacement_map() { return displacement_colours(75); }
inline const std::vector<std::string>& displacement_remarks() {
  static const std::vector<std::string> remarks = {"from rest"};
  return remarks;
}

/// Displacement of each point of the face from rest, as colours with a legend.
class DisplacementDrawing {
 public:
  /// The parts as displayed; the first face is coloured.
  explicit DisplacementDrawing(std::span<const Part> parts);

  /// Sends the colours to the renderer; a frame without a face, or with the face at rest, has none.
  void color(SceneRenderer& renderer, const FrameState& frame) const;
  /// Restores the face's own colours.
  void clear(SceneRenderer& renderer) const;
  PixelBox add_legend_to(Image& image, Backdrop backdrop) const;

 private:
  ColourMap colours_ = displacement_map();
  Glyphs words_;
  std::string name_;  // of the face; empty without one
  std::vector<Eigen::Vector3f> rest_;
};

}  // namespace condyle
