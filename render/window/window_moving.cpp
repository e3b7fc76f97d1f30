#include "render/window/pointing.h"
#include "render/window/window_state.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr double reach_px = 9;
constexpr double seen_through = 0.5;  // what is paler does not hide what is pointed at

}  // namespace

std::optional<std::size_t> Window::State::body_under(const Eigen::Vector2d& at,
                                                     Eigen::Vector3d& place) const {
  if (view.shows_face(scene) && view.skin_opacity > seen_through) return std::nullopt;
  std::vector<PointedSurface> surfaces;
  std::vector<std::size_t> parts;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    const bool seen =
        i < view.parts.size() && view.parts[i].shown && view.parts[i].opacity > seen_through;
    if (!seen || !collides(scene.parts[i].role)) continue;
    surfaces.push_back({&scene.parts[i].mesh, pose_of(scene.parts, i, frame.poses())});
    parts.push_back(i);
  }
  const auto found = pointed_place(camera, view_rect(), at, surfaces);
  if (!found) return std::nullopt;
  place = found->place;
  return movable_body_of(scene.bodies, scene.parts, parts[found->surface]);
}

/// A handle of the chosen body, else a body that is pointed at. gives: whether the hand has one.
bool Window::State::grip_body(const Eigen::Vector2d& at) {
  if (!view.move_tool || !has_frame || view.chosen >= scene.bodies.size()) return false;
  const auto pose = [&](const MovableBody& body) {
    return pose_of(scene.parts, body.part, frame.poses());
  };
  const MovableBody& chosen = scene.bodies[view.chosen];
  HandleView handle_view{camera, view_rect(), pose(chosen) * chosen.center};
  handle_view.arrow_px *= panels->theme().scale;
  handle_view.ring_px *= panels->theme().scale;
  const auto grip = grip_at(handle_view, at, reach_px * panels->theme().scale);
  if (grip) {
    held = {*grip, view.chosen, handle_view, pose(chosen), at};
  } else {
    const auto body = body_under(at, handle_view.center);
    if (!body) return false;
    view.chosen = *body;
    held = {Grip::body, *body, handle_view, pose(scene.bodies[*body]), at};
  }
  panels->remember(view);
  return true;
}

void Window::State::move_body(const Eigen::Vector2d& at) {
  const MovableBody& body = scene.bodies[held->body];
  if (!body.free) {
    view.playing = false;
    view.opening_mm.reset();
  }
  const Pose wanted = gripped(held->view, held->grip, held->start, held->from, at);
  view.hands.of(body) = carrier_pose(body, frame.X_CM).inverse() * wanted;
  last_change = Clock::now();
  frames_due = 3;
}

}  // namespace condyle
