#pragma once

#include <string>
#include <vector>

#include "render/legend.h"
#include "render/scene_renderer.h"
#include "sim/contact/distance_map.h"
#include "sim/frame/frame_state.h"

namespace condyle {

/// How far parts are from what they may meet, as colours on them with a legend.
class DistanceDrawing {
 public:
  /// Gives the renderer, drawn by the patient's parts, the finer surfaces and the colours.
  DistanceDrawing(const Case& patient, const DistanceMapSettings& settings, int threads,
                  SceneRenderer& renderer, ColourMap colours);

  void color(SceneRenderer& renderer, const FrameState& frame) const;
  PixelBox add_legend_to(Image& image, Backdrop backdrop) const {
    return add_legend(image, words_, colours_, remarks_, backdrop);
  }

 private:
  DistanceMap map_;
  ColourMap colours_;
  Lettering words_;
  int threads_;
  std::vector<std::string> names_;    // of the surfaces' parts
  std::vector<std::string> remarks_;  // for the legend
};

/// What the legend says beside the colours: distance to what, and where it has no sign.
std::vector<std::string> distance_remarks(const Case& patient);

}  // namespace condyle
