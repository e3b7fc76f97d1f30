#include "render/recording/distance_drawing.h"

#include <algorithm>

#include "engine/collide/shells.h"

namespace condyle {

std::vector<std::string> distance_remarks(const Case& patient) {
  const bool others = patient.bodies.size() > 2;
  std::vector<std::string> lines = {others ? "to parts it may touch" : "to the opposing jaw"};
  const auto is_open = [](const Part& part) {
    if (!collides(part.role)) return false;
    const auto shells = solid_shells(part.mesh);
    return std::any_of(shells.begin(), shells.end(), [](const Shell& s) { return !s.closed; });
  };
  if (std::any_of(patient.parts.begin(), patient.parts.end(), is_open))
    lines.insert(lines.end(), {"open surfaces have no inside:", "no sign near them"});
  return lines;
}

DistanceDrawing::DistanceDrawing(const Case& patient, const DistanceMapSettings& settings,
                                 int threads, SceneRenderer& renderer, ColourMap colours)
    : map_(patient, settings, threads),
      colours_(std::move(colours)),
      threads_(threads),
      remarks_(distance_remarks(patient)) {
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
