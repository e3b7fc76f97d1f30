#include "render/window/window_state.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr double reach_px = 9;

}  // namespace

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
  const auto axes = [&](const MovableBody& body) -> Eigen::Matrix3d {
    return body.is_skull() ? body.axes : frame()->poses[body.parent].R * body.axes;
  };
  const MovableBody& chosen = scene.bodies[view.chosen];
  GizmoView gizmo_view{seen(), view_rect(), pose(chosen) * chosen.center, axes(chosen)};
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
    gizmo_view.axes = axes(scene.bodies[*body]);
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
  Pose target = body.is_skull() ? input.held->start * gripped(input.held->view, input.held->grip,
                                                              {}, input.held->from, at)
                                : frame()->poses[body.parent].inverse() *
                                      gripped(input.held->view, input.held->grip, input.held->start,
                                              input.held->from, at);
  const bool snaps = glfwGetKey(window, GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS ||
                     glfwGetKey(window, GLFW_KEY_RIGHT_CONTROL) == GLFW_PRESS;
  if (snaps) target = snapped(target, body);
  view.move(body, target, X_CM);
  pacing.last_change = Clock::now();
  pacing.frames_due = 3;
}

/// X, Y and Z keep what is dragged on its axis to the left, to the back or upward; the same key
/// frees it again.
bool Window::State::choose_axis(int key) {
  if (!input.held || key < GLFW_KEY_X || key > GLFW_KEY_Z) return false;
  constexpr Grip axes[] = {Grip::left, Grip::back, Grip::up};
  const Grip axis = axes[key - GLFW_KEY_X];
  input.held->grip = input.held->grip == axis ? Grip::body : axis;
  move_body({input.mouse.now().x, input.mouse.now().y});
  return true;
}

}  // namespace condyle
