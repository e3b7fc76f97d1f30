#pragma once

#include <string>
#include <vector>

#include "render/overlay/legend.h"
#include "render/scene/scene_renderer.h"
#include "sim/contact/distance_map.h"
#include "sim/frame/frame_state.h"

namespace condyle {

/// Distances of parts to those that they may touch, as colours with a legend.
class DistanceDrawing {
 public:
  /// Sends the finer surfaces and the colours to the renderer of the patient's parts.
  DistanceDrawing(const Case& patient, const DistanceMapSettings& settings, int threads,
                  SceneRenderer& renderer, ColourMap colours);

  void color(SceneRenderer& renderer, const FrameState& frame) const;
  PixelBox add_legend_to(Image& image, Backdrop backdrop) const {
    return add_legend(image, words_, colours_, remarks_, backdrop);
  }

 private:
  DistanceMap map_;
  ColourMap colours_;
  Glyphs words_;
  int threads_;
  std::vector<std::string> names_;    // of the surfaces' parts
  std::vector<std::string> remarks_;  // for the legend
};

/// Remarks of the legend: what the distance refers to, and where it has no sign.
std::vector<std::string> distance_remarks(const Case& patient, bool open);

}  // namespace condyle
