#include <cmath>
#include <numbers>

#include "engine/mesh/measure.h"
#include "render/window/window_state.h"
#include "sim/frame/body_poses.h"

namespace condyle {

/// The visible surface at that position; its number is the part's. Parts that are seen through
/// count where nothing else is.
std::optional<PickedPoint> Window::State::surface_under(const Eigen::Vector2d& at,
                                                        bool with_face) const {
  if (view.shows_face(scene) && view.skin_opacity > seen_through && !with_face) return std::nullopt;
  const auto solid = surface_of(at, false);
  return solid ? solid : surface_of(at, true);
}

std::optional<PickedPoint> Window::State::surface_of(const Eigen::Vector2d& at, bool glass) const {
  const bool skinned = !glass && view.shows_face(scene) && view.skin_opacity > seen_through;
  std::vector<PickableSurface> surfaces;
  std::vector<std::size_t> parts;
  TriMesh face;
  const auto elsewhere = displayed_face.places(*frame());
  const auto& places = elsewhere.empty() ? frame()->face : elsewhere;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    const Part& part = scene.parts[i];
    const bool seen = i < view.parts.size() && view.parts[i].shown && view.parts[i].opacity > 0 &&
                      (view.parts[i].opacity <= seen_through) == glass;
    if (!seen || (part.role == Role::face && !skinned)) continue;
    if (part.role == Role::face && places.size() == part.mesh.vertices.size()) {
      for (const auto& p : places) face.vertices.push_back(p.cast<double>());
      face.triangles = part.mesh.triangles;
      surfaces.push_back({&face, Pose{}});
    } else {
      surfaces.push_back({&part.mesh, pose_of(scene.parts[i], frame()->poses)});
    }
    parts.push_back(i);
  }
  auto found = pick_point(seen(), view_rect(), at, surfaces);
  if (found) found->surface = parts[found->surface];
  return found;
}

/// Selects the clicked part; a double click focuses it, the right button opens its menu.
void Window::State::on_click(const ClickDetector::Click& click) {
  if (!frame()) return;
  const bool left = click.button == GLFW_MOUSE_BUTTON_LEFT;
  if (!left && click.button != GLFW_MOUSE_BUTTON_RIGHT) return;
  if (left && view.tool == Tool::cut) {
    if (!click.is_double) add_cut_point(click.at);
    return;
  }
  if (left && view.tool != Tool::look && view.tool != Tool::move) return;
  const auto found = surface_under(click.at, true);
  view.selected.reset();
  if (found) view.selected = found->surface;
  pacing.frames_due = 3;
  if (!found) return;
  if (!left)
    input.menu = {
        {found->surface, found->triangle, found->barycentric}, click.at.x(), click.at.y()};
  else if (click.is_double)
    focus(found->surface);
}

/// The camera turns about the part and comes so near that it fills the view.
void Window::State::focus(std::size_t part) {
  if (!frame() || part >= scene.parts.size()) return;
  constexpr double air = 1.15;
  const Box bounds = bounding_box(scene.parts[part].mesh);
  const Pose X_RC = view.hands.X_RC(frame()->poses[view.hands.jaw]);
  camera.target = X_RC * (pose_of(scene.parts[part], frame()->poses) * bounds.center());
  const ViewRect rect = view_rect();
  const double half = std::tan(camera.field_of_view_deg * std::numbers::pi / 360) *
                      std::min(1.0, rect.width / rect.height);
  const double radius = 0.5 * (bounds.high - bounds.low).norm();
  camera.distance_mm =
      std::clamp(air * radius / std::sin(std::atan(half)), zoom.nearest_mm, zoom.farthest_mm);
  pacing.scene_changed = true;
  pacing.last_change = Clock::now();
}

}  // namespace condyle
