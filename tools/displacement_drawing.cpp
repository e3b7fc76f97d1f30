#include "tools/displacement_drawing.h"

namespace condyle {

DisplacementDrawing::DisplacementDrawing(const Case& patient, double most_mm,
                                         SceneRenderer& renderer)
    : colours_(displacement_colours(most_mm)) {
  renderer.set_colour_map(colours_);
  const Part* face = patient.find(Role::face);
  if (!face) return;
  name_ = face->name;
  for (const auto& v : face->mesh.vertices) rest_.push_back(v.cast<float>());
}

void DisplacementDrawing::color(SceneRenderer& renderer, const FrameState& frame) const {
  if (name_.empty()) return;
  std::vector<float> way(rest_.size(), 0.f);
  if (frame.face.size() == rest_.size())
    for (std::size_t v = 0; v < way.size(); ++v) way[v] = (frame.face[v] - rest_[v]).norm();
  renderer.color_part(name_, way);
}

void DisplacementDrawing::clear(SceneRenderer& renderer) const {
  if (!name_.empty()) renderer.color_part(name_, {});
}

}  // namespace condyle
