#include "render/recording/distance_drawing.h"

#include "sim/contact/distance_map.h"

namespace condyle {

std::vector<std::string> distance_remarks(const Case& patient, bool open) {
  const bool others = patient.bodies.size() > 2;
  std::vector<std::string> lines = {others ? "to parts it may touch" : "to the opposing jaw"};
  if (open) lines.insert(lines.end(), {"open surfaces have no inside:", "no sign near them"});
  return lines;
}

DistanceDrawing::DistanceDrawing(const Case& patient, const DistanceMapSettings& settings,
                                 int threads, SceneRenderer& renderer, ColourMap colours)
    : map_(patient, settings, threads),
      colours_(std::move(colours)),
      threads_(threads),
      remarks_(distance_remarks(patient, has_open_surfaces(patient))) {
  renderer.set_colour_map(colours_);
  for (const auto& surface : map_.surfaces()) {
    names_.push_back(patient.parts[static_cast<std::size_t>(surface.part)].name);
    renderer.set_finer(names_.back(), surface.mesh, surface.normals);
  }
}

void DistanceDrawing::color(SceneRenderer& renderer, const FrameState& frame) const {
  const auto values = map_.at(frame.poses, threads_);
  for (std::size_t s = 0; s < names_.size(); ++s) renderer.color_part(names_[s], values[s]);
}

}  // namespace condyle
