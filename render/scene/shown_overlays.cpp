#include "render/scene/shown_overlays.h"

#include "render/scene/scene_renderer.h"

namespace condyle {

void OverlaySender::send(SceneRenderer& renderer, const Overlays& overlays) {
  for (const auto& name : lines_)
    if (!overlays.lines.contains(name)) renderer.set_lines(name, {});
  for (const auto& name : sheets_)
    if (!overlays.sheets.contains(name)) renderer.set_sheet(name, {});
  for (const auto& name : bodies_)
    if (!overlays.bodies.contains(name)) renderer.set_body(name, {});
  lines_.clear();
  sheets_.clear();
  bodies_.clear();
  for (const auto& [name, lines] : overlays.lines) {
    renderer.set_lines(name, lines);
    lines_.insert(name);
  }
  for (const auto& [name, sheet] : overlays.sheets) {
    renderer.set_sheet(name, sheet);
    sheets_.insert(name);
  }
  for (const auto& [name, body] : overlays.bodies) {
    renderer.set_body(name, body);
    bodies_.insert(name);
  }
}

}  // namespace condyle
