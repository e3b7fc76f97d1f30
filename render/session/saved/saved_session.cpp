#include "render/session/saved/saved_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/session/saved/session_fields.h"

namespace condyle {
namespace {

constexpr double same_place_mm = 1e-6;

std::vector<std::string> item_names(const std::vector<TreeItem>& items) {
  std::vector<std::string> names;
  for (const TreeItem& item : items) names.push_back(item.name);
  return names;
}

std::vector<std::string> part_names(const WindowScene& scene) {
  std::vector<std::string> names;
  for (const Part& part : scene.parts) names.push_back(part.name);
  return names;
}

std::optional<std::size_t> place_in(const std::vector<std::string>& names,
                                    const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (name.empty() || found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

/// Names of the movable bodies, by BodyId.
std::vector<std::string> body_names(const WindowScene& scene) {
  std::vector<std::string> names;
  for (const MovableBody& body : scene.bodies) {
    if (names.size() <= index_of(body.body)) names.resize(index_of(body.body) + 1);
    names[index_of(body.body)] = scene.parts[body.part].name;
  }
  return names;
}

/// Position of a measured point at rest; none if its part has no such triangle.
std::optional<Eigen::Vector3d> place_at_rest(const PinnedPoint& point, const WindowScene& scene) {
  if (point.part >= scene.parts.size()) return std::nullopt;
  const auto& vertices = scene.parts[point.part].mesh.vertices;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto corner = static_cast<std::size_t>(point.triangle[i]);
    if (point.triangle[i] < 0 || corner >= vertices.size()) return std::nullopt;
    at += point.barycentric[i] * vertices[corner];
  }
  return at;
}

/// How the named items of a scene are shown: as saved; others by default.
std::vector<PartView> fitted_parts(const std::vector<PartView>& saved,
                                   const std::vector<std::string>& saved_names,
                                   const std::vector<std::string>& names,
                                   std::vector<PartView> views, int& lost) {
  views.resize(names.size());
  for (std::size_t i = 0; i < saved.size() && i < saved_names.size(); ++i) {
    if (const auto place = place_in(names, saved_names[i]))
      views[*place] = saved[i];
    else
      ++lost;
  }
  return views;
}

std::string plural(int count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

void fit_points(const SavedSession& session, const WindowScene& scene, ViewState& view,
                std::vector<std::string>& left_out) {
  const std::vector<std::string> parts = part_names(scene);
  view.measured.clear();
  for (std::size_t i = 0; i < session.view.measured.size(); ++i) {
    PinnedPoint point = session.view.measured[i];
    const auto part = point.part < session.names.parts.size()
                          ? place_in(parts, session.names.parts[point.part])
                          : std::nullopt;
    if (!part) continue;
    point.part = *part;
    const auto at = place_at_rest(point, scene);
    if (!at || i >= session.measured_at_rest.size() ||
        (*at - session.measured_at_rest[i]).norm() > same_place_mm)
      continue;
    view.measured.push_back(point);
  }
  if (const auto lost = static_cast<int>(session.view.measured.size() - view.measured.size()))
    left_out.push_back(plural(lost, "measured point lies", "measured points lie") +
                       " on a surface that has changed");
}

/// The selected part, and the bone on which a cut is drawn.
void fit_chosen_parts(const SavedSession& session, const WindowScene& scene, ViewState& view,
                      std::vector<std::string>& left_out) {
  const std::vector<std::string> parts = part_names(scene);
  const auto fitted = [&](const std::optional<std::size_t>& part) -> std::optional<std::size_t> {
    if (!part || *part >= session.names.parts.size()) return std::nullopt;
    return place_in(parts, session.names.parts[*part]);
  };
  view.selected = fitted(session.view.selected);
  view.drawn_cut.part = fitted(session.view.drawn_cut.part);
  if (view.drawn_cut.part || !session.view.drawn_cut.part) return;
  view.drawn_cut = {};
  left_out.push_back("a cut was drawn on a bone that is not there");
}

void fit_landmarks(const SavedSession& session, const WindowScene& scene, ViewState& view) {
  const std::vector<std::string> parts = part_names(scene);
  for (Landmark& landmark : view.landmarks) {
    const auto part = landmark.part < session.names.parts.size()
                          ? place_in(parts, session.names.parts[landmark.part])
                          : std::nullopt;
    const auto vertex = static_cast<std::size_t>(landmark.vertex);
    if (part && vertex < scene.parts[*part].mesh.vertices.size())
      landmark.part = *part;
    else if (!scene.parts.empty())
      landmark = landmark_at(landmark.name, landmark.at_rest, scene.parts);
  }
  if (view.landmark && *view.landmark >= view.landmarks.size()) view.landmark.reset();
}

void fit_hands(const SavedSession& session, const WindowScene& scene, ViewState& view,
               std::vector<std::string>& left_out) {
  const std::vector<std::string> bodies = body_names(scene);
  view.hands.X_PB.clear();
  const auto jaw = index_of(view.hands.jaw);
  if (const auto body = place_in(
          bodies, jaw < session.names.bodies.size() ? session.names.bodies[jaw] : std::string()))
    view.hands.jaw = BodyId{static_cast<int>(*body)};
  else
    view.hands.jaw = Hands{}.jaw;
  for (std::size_t i = 0; i < session.view.hands.X_PB.size(); ++i) {
    const auto& target = session.view.hands.X_PB[i];
    if (!target) continue;
    const std::string name = i < session.names.bodies.size() ? session.names.bodies[i] : "";
    if (const auto body = place_in(bodies, name))
      view.hands.set(BodyId{static_cast<int>(*body)}, target);
    else
      left_out.push_back(name + " was moved by hand and is not there");
  }
  view.chosen = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.parts[scene.bodies[i].part].name == session.names.chosen) view.chosen = i;
}

}  // namespace

bool same_session(const SavedSession& a, const SavedSession& b) {
  const auto same_camera = [](const Camera& one, const Camera& other) {
    return one.target == other.target && one.direction == other.direction && one.up == other.up &&
           one.distance_mm == other.distance_mm &&
           one.field_of_view_deg == other.field_of_view_deg && one.near_mm == other.near_mm;
  };
  const bool same_clock = a.view.time_s == b.view.time_s || (a.view.playing && b.view.playing);
  return same_clock && session_fields::same_controls(a.view, b.view) &&
         a.view.edits() == b.view.edits() &&
         static_cast<const PanelChoice&>(a.view) == static_cast<const PanelChoice&>(b.view) &&
         same_camera(a.camera, b.camera) && a.names == b.names && a.source == b.source &&
         a.geometry == b.geometry && a.landmarks_replaced == b.landmarks_replaced &&
         a.plan == b.plan && a.draft == b.draft && a.saved_as == b.saved_as;
}

SavedSession saved_view(const ViewState& view, const WindowScene& scene, const Camera& camera) {
  SavedSession session{.camera = camera, .view = view};
  session.view.falling = false;
  session.view.held_handle.reset();
  session.names = {.parts = part_names(scene),
                   .muscles = item_names(scene.muscles),
                   .layers = item_names(scene.layers),
                   .bodies = body_names(scene)};
  if (view.chosen < scene.bodies.size())
    session.names.chosen = scene.parts[scene.bodies[view.chosen].part].name;
  session.view.measured.clear();
  for (const PinnedPoint& point : view.measured)
    if (const auto at = place_at_rest(point, scene)) {
      session.view.measured.push_back(point);
      session.measured_at_rest.push_back(*at);
    }
  return session;
}

ViewState fitted_view(const SavedSession& session, const WindowScene& scene,
                      std::vector<std::string>& left_out) {
  ViewState view = session.view;
  ViewState fresh;
  fresh.fit(scene);  // with its defaults for what the session does not know
  int lost = 0;
  view.parts = fitted_parts(session.view.parts, session.names.parts, part_names(scene),
                            std::move(fresh.parts), lost);
  view.muscles = fitted_parts(session.view.muscles, session.names.muscles,
                              item_names(scene.muscles), std::move(fresh.muscles), lost);
  view.layers = fitted_parts(session.view.layers, session.names.layers, item_names(scene.layers),
                             std::move(fresh.layers), lost);
  if (lost > 0)
    left_out.push_back(plural(lost, "entry of the tree is", "entries of the tree are") +
                       " not there");
  std::erase_if(view.expression, [&](const ExpressionLevel& level) {
    const auto names = item_names(scene.expressions);
    const bool unknown = std::find(names.begin(), names.end(), level.name) == names.end();
    if (unknown) left_out.push_back("the expression " + level.name);
    return unknown;
  });
  fit_points(session, scene, view, left_out);
  fit_landmarks(session, scene, view);
  fit_chosen_parts(session, scene, view, left_out);
  fit_hands(session, scene, view, left_out);
  return view;
}

}  // namespace condyle
