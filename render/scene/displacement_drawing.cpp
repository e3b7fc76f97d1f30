#include "render/scene/displacement_drawing.h"

#include <algorithm>

namespace condyle {

DisplacementDrawing::DisplacementDrawing(std::span<const Part> parts) {
  const auto face = std::find_if(parts.begin(), parts.end(),
                                 [](const Part& part) { return part.role == Role::face; });
  if (face == parts.end()) return;
  name_ = face->name;
  for (const auto& v : face->mesh.vertices) rest_.push_back(v.cast<float>());
}

void DisplacementDrawing::color(SceneRenderer& renderer, const FrameState& frame) const {
  if (name_.empty()) return;
  std::vector<float> displacement(rest_.size(), 0.f);
  if (frame.face.size() == rest_.size())
    for (std::size_t v = 0; v < displacement.size(); ++v)
      displacement[v] = (frame.face[v] - rest_[v]).norm();
  renderer.set_colour_map(colours_);
  renderer.color_part(name_, displacement);
}

void DisplacementDrawing::clear(SceneRenderer& renderer) const {
  if (!name_.empty()) renderer.color_part(name_, {});
}

PixelBox DisplacementDrawing::add_legend_to(Image& image, Backdrop backdrop) const {
  return add_legend(image, words_, colours_, displacement_remarks(), backdrop);
}

}  // namespace condyle
