#include <algorithm>
#include <cmath>
#include <limits>

#include "render/window/window_state.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double handle_reach_px = 10;

/// The point under the mouse at the depth of another one.
Vector3d point_beside(const Camera& camera, const ViewRect& rect, const Vector2d& mouse,
                      const Vector3d& other) {
  const GizmoView view{camera, rect, other};
  return other + gripped(view, Grip::body, {}, screen_place(camera, rect, other), mouse).t;
}

/// Of the vertices of a mesh that appear nearest to the mouse, the one nearest to the eye.
Vector3d nearest_on_screen(const TriMesh& mesh, const Pose& X_CB, const Camera& camera,
                           const ViewRect& rect, const Vector2d& mouse) {
  constexpr double tolerance_px = 3;
  const Vector3d toward = picture_axes(camera).row(2);
  std::vector<double> distance;
  for (const Vector3d& v : mesh.vertices)
    distance.push_back((screen_place(camera, rect, X_CB * v) - mouse).norm());
  const double least = *std::min_element(distance.begin(), distance.end());
  Vector3d nearest = X_CB * mesh.vertices.front();
  double front = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const Vector3d p = X_CB * mesh.vertices[i];
    if (distance[i] > least + tolerance_px || toward.dot(p) <= front) continue;
    front = toward.dot(p);
    nearest = p;
  }
  return nearest;
}

}  // namespace

/// The place of a cut's point under the mouse: on the bone, or beside it at the depth of its
/// nearest edge; in the frame in which the bone is at rest. None where the skin is in front.
std::optional<Vector3d> Window::State::cut_point(const Vector2d& at, std::size_t part) const {
  const Part& bone = scene.parts[part];
  if (bone.mesh.vertices.empty()) return std::nullopt;
  const Pose X_CB = pose_of(bone, frame()->poses);
  if (const auto found = surface_under(at, true);
      found && scene.parts[found->surface].role == Role::face)
    return std::nullopt;
  // Teeth and other bones in front do not count.
  const PickableSurface surface{&bone.mesh, X_CB};
  if (const auto found = pick_point(seen(), view_rect(), at, {&surface, 1}))
    return X_CB.inverse() * found->place;
  const Vector3d edge = nearest_on_screen(bone.mesh, X_CB, seen(), view_rect(), at);
  return X_CB.inverse() * point_beside(seen(), view_rect(), at, edge);
}

/// Adds a point to the drawn cut; the first one chooses the bone and the direction of the saw.
void Window::State::add_cut_point(const Vector2d& at) {
  if (!frame()) return;
  DrawnCut drawn = view.drawn_cut;
  // Beside a selected bone, parts that are seen through do not count.
  const bool selected = view.selected && can_be_cut(scene.parts[*view.selected]);
  const auto found = drawn.part || selected ? surface_of(at, false) : surface_under(at, true);
  if (found && scene.parts[found->surface].role == Role::face)
    return panels->say("The skin is in front of the bone; key K hides it");
  if (!drawn.part && !found && selected) drawn.part = view.selected;
  if (!drawn.part) {
    if (!found || !can_be_cut(scene.parts[found->surface]))
      return panels->say(found ? "Cuts are drawn on bone" : "Click the bone to be cut first");
    drawn.part = found->surface;
  }
  const auto place = cut_point(at, *drawn.part);
  if (!place) return;
  if (drawn.points.empty()) {
    const Pose X_CB = pose_of(scene.parts[*drawn.part], frame()->poses);
    drawn.direction = -(X_CB.R.inverse() * seen().direction).normalized();
  }
  drawn.points.push_back(*place);
  panels->remember(view);
  view.drawn_cut = std::move(drawn);
  pacing.frames_due = 3;
}

/// Grips a point of the drawn cut, else a handle of the plan's selected step. Returns whether one
/// is held.
bool Window::State::grip_handle(const Vector2d& at) {
  if (!frame() || (view.tool != Tool::cut && view.tool != Tool::look)) return false;
  double nearest = handle_reach_px * panels->theme().scale;
  std::optional<HeldHandle> held;
  const auto offer = [&](const HeldHandle& handle, const Vector3d& place) {
    const double distance = (screen_place(seen(), view_rect(), place) - at).norm();
    if (distance >= nearest) return;
    nearest = distance;
    held = handle;
  };
  if (view.tool == Tool::cut && view.drawn_cut.part) {
    const Pose X_CB = pose_of(scene.parts[*view.drawn_cut.part], frame()->poses);
    for (std::size_t i = 0; i < view.drawn_cut.points.size(); ++i)
      offer({.is_drawn = true, .index = i, .at = view.drawn_cut.points[i]},
            X_CB * view.drawn_cut.points[i]);
  }
  if (panels->shows_handles(view))
    for (std::size_t i = 0; i < scene.plan.handles.size(); ++i) {
      const PlanHandle& handle = scene.plan.handles[i];
      offer({.index = i, .at = handle.at, .value = handle.value},
            frame()->poses[handle.body] * handle.at);
    }
  if (!held) return false;
  view.held_handle = held;
  input.gripped_at = at;
  return true;
}

void Window::State::move_handle(const Vector2d& at) {
  HeldHandle& held = *view.held_handle;
  pacing.frames_due = 3;
  if (held.is_drawn) {
    if (!view.drawn_cut.part || held.index >= view.drawn_cut.points.size()) return;
    const auto place = cut_point(at, *view.drawn_cut.part);
    if (!place) return;
    if (!held.moved) panels->remember(view);
    held.moved = true;
    view.drawn_cut.points[held.index] = held.at = *place;
    return;
  }
  if (held.index >= scene.plan.handles.size()) return;
  const PlanHandle& handle = scene.plan.handles[held.index];
  const Pose& X_CB = frame()->poses[handle.body];
  const int step = scene.plan.handles_of;
  if (const PlanNumber* number = number_of(scene.plan, handle)) {
    const Vector3d from = X_CB * handle.at;
    const Vector2d per_unit = screen_place(seen(), view_rect(), from + X_CB.R * handle.per_unit) -
                              screen_place(seen(), view_rect(), from);
    constexpr double least_px = 0.5;  // seen along the axis, it would run away from the mouse
    const double change = (at - input.gripped_at).dot(per_unit) /
                          std::max(per_unit.squaredNorm(), least_px * least_px);
    const double value =
        std::clamp(std::round(10 * (handle.value + change)) / 10, number->low, number->high);
    if (value == held.value) return;
    held.value = value;
    held.at = handle.at + (value - handle.value) * handle.per_unit;
    panels->request(request::PreviewCut{plan_edit::SetNumber{step, handle.number, value}});
    return;
  }
  std::optional<Vector3d> place;
  for (std::size_t part = 0; part < scene.parts.size() && !place; ++part)
    if (scene.parts[part].body == handle.body && can_be_cut(scene.parts[part]))
      place = cut_point(at, part);
  if (!place) return;
  held.at = *place;
  panels->request(
      request::PreviewCut{plan_edit::MovePoint{step, handle.surface, handle.point, *place}});
}

/// A handle of the plan that was dragged changes its step.
void Window::State::release_handle() {
  const auto held = std::exchange(view.held_handle, std::nullopt);
  pacing.frames_due = 3;
  if (!held || held->is_drawn || held->index >= scene.plan.handles.size()) return;
  const PlanHandle& handle = scene.plan.handles[held->index];
  if (held->at == handle.at) return;
  const int step = scene.plan.handles_of;
  panels->request(request::PreviewCut{});
  if (handle.number.empty())
    panels->request(
        request::EditPlan{plan_edit::MovePoint{step, handle.surface, handle.point, held->at}});
  else
    panels->request(request::EditPlan{plan_edit::SetNumber{step, handle.number, held->value}});
}

}  // namespace condyle
