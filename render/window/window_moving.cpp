#include "render/window/window_state.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr double reach_px = 9;
constexpr double seen_through = 0.5;  // paler surfaces do not obstruct picking

}  // namespace

/// The visible surface at that position; its number is the part's.
std::optional<PickedPoint> Window::State::surface_under(const Eigen::Vector2d& at,
                                                        bool with_face) const {
  const bool skinned = view.shows_face(scene) && view.skin_opacity > seen_through;
  if (skinned && !with_face) return std::nullopt;
  std::vector<PickableSurface> surfaces;
  std::vector<std::size_t> parts;
  TriMesh face;
  const auto elsewhere = displayed_face.places(*frame());
  const auto& places = elsewhere.empty() ? frame()->face : elsewhere;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    const Part& part = scene.parts[i];
    const bool seen =
        i < view.parts.size() && view.parts[i].shown && view.parts[i].opacity > seen_through;
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

/// Sets a point of the clicked surface to measure or to place a landmark. Returns whether there is
/// one.
bool Window::State::set_point(const Eigen::Vector2d& at) {
  const bool places = view.tool == Tool::landmarks && view.landmark;
  if ((view.tool != Tool::measure && !places) || !frame()) return false;
  const auto found = surface_under(at, true);
  if (!found) return false;
  panels->remember(view);
  if (places) {
    Landmark& landmark = view.landmarks[*view.landmark];
    landmark = landmark_on(landmark.name, {found->surface, found->triangle, found->barycentric},
                           scene.parts);
    pacing.frames_due = 3;
    return true;
  }
  view.measured.push_back({found->surface, found->triangle, found->barycentric});
  return true;
}

/// Grips a handle of the selected body, else the body under the mouse. Returns whether one is held.
bool Window::State::grip_body(const Eigen::Vector2d& at) {
  if (view.tool != Tool::move || !frame() || view.chosen >= scene.bodies.size()) return false;
  const auto pose = [&](const MovableBody& body) { return frame()->poses[body.body]; };
  const MovableBody& chosen = scene.bodies[view.chosen];
  GizmoView gizmo_view{seen(), view_rect(), pose(chosen) * chosen.center};
  gizmo_view.arrow_px *= panels->theme().scale;
  gizmo_view.ring_px *= panels->theme().scale;
  const auto grip = grip_at(gizmo_view, at, reach_px * panels->theme().scale);
  if (grip) {
    input.held = {
        *grip, view.chosen, gizmo_view,
        chosen.is_skull() ? view.hands.X_RC(frame()->poses[view.hands.jaw]) : pose(chosen), at};
  } else {
    const auto found = surface_under(at, false);
    if (!found) return false;
    const auto body = movable_body_of(scene.bodies, scene.parts, found->surface);
    // The skull fills the picture: it is gripped only when selected, else the view turns.
    if (!body || scene.bodies[*body].is_skull()) return false;
    gizmo_view.center = found->place;
    view.chosen = *body;
    input.held = {Grip::body, *body, gizmo_view, pose(scene.bodies[*body]), at};
  }
  panels->remember(view);
  return true;
}

void Window::State::move_body(const Eigen::Vector2d& at) {
  const MovableBody& body = scene.bodies[input.held->body];
  const Pose& X_CM = frame()->poses[view.hands.jaw];
  // The skull's handles are expressed in its own frame at the moment of the grip.
  const Pose target = body.is_skull()
                          ? input.held->start * gripped(input.held->view, input.held->grip, {},
                                                        input.held->from, at)
                          : frame()->poses[body.parent].inverse() *
                                gripped(input.held->view, input.held->grip, input.held->start,
                                        input.held->from, at);
  view.move(body, target, X_CM);
  pacing.last_change = Clock::now();
  pacing.frames_due = 3;
}

}  // namespace condyle
