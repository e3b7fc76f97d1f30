#include "render/window/shown_overlays.h"

#include <array>

#include "render/scene_renderer.h"

namespace condyle {

LineSet patient_axes(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  LineSet axes;
  const Eigen::Vector3f middle = ((low + high) / 2).cast<float>();
  const float length = 0.6f * static_cast<float>((high - low).maxCoeff());
  constexpr std::array<std::array<float, 3>, 3> tints = {
      {{0.91f, 0.44f, 0.23f}, {0.18f, 0.75f, 0.58f}, {0.34f, 0.71f, 0.91f}}};
  for (int i = 0; i < 3; ++i) {
    const std::size_t before = axes.ends.size();
    add_arrow(axes, middle, middle + length * Eigen::Vector3f::Unit(i));
    const auto& tint = tints[static_cast<std::size_t>(i)];
    axes.colors.insert(axes.colors.end(), (axes.ends.size() - before) / 2,
                       Eigen::Vector3f(tint[0], tint[1], tint[2]));
  }
  return axes;
}

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
