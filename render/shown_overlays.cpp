#include "render/shown_overlays.h"

#include "render/scene_renderer.h"

namespace condyle {

void OverlaySender::send(SceneRenderer& renderer, const Overlays& wanted) {
  for (const auto& name : lines_)
    if (!wanted.lines.contains(name)) renderer.set_lines(name, {});
  for (const auto& name : sheets_)
    if (!wanted.sheets.contains(name)) renderer.set_sheet(name, {});
  lines_.clear();
  sheets_.clear();
  for (const auto& [name, lines] : wanted.lines) {
    renderer.set_lines(name, lines);
    lines_.insert(name);
  }
  for (const auto& [name, sheet] : wanted.sheets) {
    renderer.set_sheet(name, sheet);
    sheets_.insert(name);
  }
}

}  // namespace condyle
