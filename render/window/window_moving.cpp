#include "render/window/window_state.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr double reach_px = 9;
constexpr double seen_through = 0.5;  // what is paler does not hide what is pointed at

}  // namespace

/// The surface that is seen there; its number is the part's.
std::optional<PointedPlace> Window::State::surface_under(const Eigen::Vector2d& at,
                                                         bool with_face) const {
  const bool skinned = view.shows_face(scene) && view.skin_opacity > seen_through;
  if (skinned && !with_face) return std::nullopt;
  std::vector<PointedSurface> surfaces;
  std::vector<std::size_t> parts;
  TriMesh face;
  const auto elsewhere = seen_face.places(*frame());
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
      surfaces.push_back({&part.mesh, pose_of(scene.parts, i, frame()->poses())});
    }
    parts.push_back(i);
  }
  auto found = pointed_place(seen(), view_rect(), at, surfaces);
  if (found) found->surface = parts[found->surface];
  return found;
}

/// Measuring, placing a landmark: a point of the surface that is clicked. gives: whether there is
/// one.
bool Window::State::set_point(const Eigen::Vector2d& at) {
  const bool places = view.tool == Tool::landmarks && view.landmark;
  if ((view.tool != Tool::measure && !places) || !frame()) return false;
  const auto found = surface_under(at, true);
  if (!found) return false;
  panels->remember(view);
  if (places) {
    Landmark& landmark = view.landmarks[*view.landmark];
    landmark =
        landmark_on(landmark.name, {found->surface, found->triangle, found->shares}, scene.parts);
    frames_due = 3;
    return true;
  }
  view.measured.push_back({found->surface, found->triangle, found->shares});
  return true;
}

/// A handle of the chosen body, else a body that is pointed at. gives: whether the hand has one.
bool Window::State::grip_body(const Eigen::Vector2d& at) {
  if (view.tool != Tool::move || !frame() || view.chosen >= scene.bodies.size()) return false;
  const auto pose = [&](const MovableBody& body) {
    return pose_of(scene.parts, body.part, frame()->poses());
  };
  const MovableBody& chosen = scene.bodies[view.chosen];
  HandleView handle_view{seen(), view_rect(), pose(chosen) * chosen.center};
  handle_view.arrow_px *= panels->theme().scale;
  handle_view.ring_px *= panels->theme().scale;
  const auto grip = grip_at(handle_view, at, reach_px * panels->theme().scale);
  if (grip) {
    held = {*grip, view.chosen, handle_view,
            chosen.skull ? view.hands.X_RC(frame()->X_CM) : pose(chosen), at};
  } else {
    const auto found = surface_under(at, false);
    if (!found) return false;
    const auto body = movable_body_of(scene.bodies, scene.parts, found->surface);
    // The skull fills the picture: it goes along only where it is chosen, else the view turns.
    if (!body || scene.bodies[*body].skull) return false;
    handle_view.center = found->place;
    view.chosen = *body;
    held = {Grip::body, *body, handle_view, pose(scene.bodies[*body]), at};
  }
  panels->remember(view);
  return true;
}

void Window::State::move_body(const Eigen::Vector2d& at) {
  const MovableBody& body = scene.bodies[held->body];
  const Pose& X_CM = frame()->X_CM;
  // The skull's handles are told in its own frame, as it was gripped.
  const Pose wanted = body.skull ? held->start * gripped(held->view, held->grip, {}, held->from, at)
                                 : carrier_pose(body, X_CM).inverse() *
                                       gripped(held->view, held->grip, held->start, held->from, at);
  view.move(body, wanted, X_CM);
  last_change = Clock::now();
  frames_due = 3;
}

}  // namespace condyle
