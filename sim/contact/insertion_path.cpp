#include "sim/contact/insertion_path.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "sim/contact/graft_surroundings.h"
#include "sim/contact/turned_path.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double farthest_mm = GraftSurroundings::farthest_mm;
constexpr double seat_mm = 2;               // of the path, where the faces are near by intention
constexpr double blocking_depth_mm = 0.05;  // of samples in other bone

/// A direction brought into the cone of the faces: the part of it that points into bone is removed.
std::optional<Vector3d> into_cone(Vector3d d, const std::vector<Vector3d>& normals) {
  constexpr double beside = 1e-6;
  const Vector3d preferred = d;
  for (const Vector3d& n : normals)
    if (n.dot(d) < 0) d -= n.dot(d) * n;
  const bool outside = std::any_of(normals.begin(), normals.end(),
                                   [&](const Vector3d& n) { return n.dot(d) < -beside; });
  if (outside && normals.size() == 2) {
    const Vector3d along = normals[0].cross(normals[1]);
    d = along.dot(preferred) < 0 ? Vector3d(-along) : along;
  }
  if (d.norm() < 0.05) return std::nullopt;
  d.normalize();
  for (const Vector3d& n : normals)
    if (n.dot(d) < -1e-3) return std::nullopt;
  return d;
}

std::vector<Vector3d> directions_of(const Seat& seat) {
  std::vector<Vector3d> directions;
  const auto add = [&](const Vector3d& preferred) {
    const auto d = into_cone(preferred.normalized(), seat.face_normals);
    if (d && std::none_of(directions.begin(), directions.end(),
                          [&](const Vector3d& known) { return known.dot(*d) > 0.9999; }))
      directions.push_back(*d);
  };
  const Vector3d approach = seat.approach.normalized();
  add(approach);
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& n : seat.face_normals) middle += n;
  if (middle.norm() > 0.1) {
    add(middle);
    add(middle.normalized() + approach);
  }
  constexpr double around_deg[] = {25, 50};
  const Vector3d u = approach.unitOrthogonal(), v = approach.cross(u);
  for (const double degrees : around_deg)
    for (int i = 0; i < 8; ++i) {
      const double turn = i * std::numbers::pi / 4, tilt = degrees * std::numbers::pi / 180;
      add(std::cos(tilt) * approach + std::sin(tilt) * (std::cos(turn) * u + std::sin(turn) * v));
    }
  return directions;
}

InsertionPath examine(const GraftSurroundings& around, const Vector3d& direction) {
  constexpr double fine_mm = 0.25, fine_part_mm = 10, coarse_mm = 1;
  InsertionPath path;
  path.direction = direction;
  path.margin_mm = farthest_mm;
  // Overlap at the seat may only become less; beyond seat_mm there may be none.
  double allowed = std::min(around.at({}).mm, 0.);
  for (double s = fine_mm; s <= path_length_mm; s += s < fine_part_mm ? fine_mm : coarse_mm) {
    const Clearance found = around.at({Eigen::Quaterniond::Identity(), s * direction});
    if (found.mm < allowed - blocking_depth_mm || (s >= seat_mm && found.mm < -blocking_depth_mm)) {
      path.blocked_by = *found.part;
      path.margin_part.clear();
      path.margin_mm = path.margin_after_mm = 0;
      path.margin_at = found.at;
      return path;
    }
    allowed = std::max(allowed, std::min(found.mm, 0.));
    path.blocked_after_mm = path.length_mm = s;
    if (s < seat_mm || found.mm >= path.margin_mm) continue;
    path.margin_mm = found.mm;
    path.margin_after_mm = s;
    path.margin_at = found.at;
    path.margin_part = *found.part;
  }
  path.state =
      path.margin_mm < tight_margin_mm ? InsertionPath::State::tight : InsertionPath::State::free;
  return path;
}

/// Measures a path with turns.
InsertionPath examine_turned(const GraftSurroundings& around, const std::vector<Pose>& poses,
                             int threads) {
  InsertionPath path;
  path.poses = poses;
  path.margin_mm = farthest_mm;
  std::vector<Clearance> found(poses.size());
  parallel_for(poses.size(), threads, [&](std::size_t i) { found[i] = around.at(poses[i]); });
  constexpr double first_mm = 10;  // whose direction is that of the path
  bool is_out = false;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Vector3d shift = poses[i] * around.middle() - around.middle();
    path.length_mm += (poses[i] * around.middle() - poses[i - 1] * around.middle()).norm();
    path.turn_deg = std::max(path.turn_deg, rotation_angle(poses[i]) * 180 / std::numbers::pi);
    if (shift.norm() < first_mm || i == 1) path.direction = shift.normalized();
    is_out = is_out || around.displacement(poses[i]) >= seat_mm;
    if (!is_out || found[i].mm >= path.margin_mm) continue;
    path.margin_mm = found[i].mm;
    path.margin_after_mm = path.length_mm;
    path.margin_at = found[i].at;
    path.margin_part = *found[i].part;
  }
  path.state =
      path.margin_mm < tight_margin_mm ? InsertionPath::State::tight : InsertionPath::State::free;
  return path;
}

/// Whether the first path is the better one; of equal ones the earlier stays.
bool is_better(const InsertionPath& a, const InsertionPath& b) {
  const auto rank = [](const InsertionPath& path) {
    return path.state == InsertionPath::State::free    ? 2
           : path.state == InsertionPath::State::tight ? 1
                                                       : 0;
  };
  if (rank(a) != rank(b)) return rank(a) > rank(b);
  // Beyond half a millimetre more distance is no gain: the approach comes first in the list.
  constexpr double ample_mm = 0.5;
  return a.state == InsertionPath::State::blocked
             ? a.blocked_after_mm > b.blocked_after_mm
             : std::min(a.margin_mm, ample_mm) > std::min(b.margin_mm, ample_mm) + 1e-6;
}

std::string direction_words(const Vector3d& d) {
  const char* const names[3][2] = {
      {"to the right", "to the left"}, {"forward", "backward"}, {"down", "up"}};
  std::vector<std::pair<double, std::string>> words;
  for (int k = 0; k < 3; ++k)
    if (std::abs(d[k]) > 0.3) words.emplace_back(-std::abs(d[k]), names[k][d[k] > 0]);
  std::stable_sort(words.begin(), words.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i].second;
  return text;
}

}  // namespace

InsertionPath find_insertion_path(const Case& patient, const Seat& seat, int threads) {
  std::vector<BodyId> graft;
  for (const std::string& name : seat.bodies) {
    const auto body = patient.bodies.find(name);
    if (!body) throw InputError(fmt::format("the patient has no body \"{}\"", name));
    graft.push_back(*body);
  }
  const GraftSurroundings around(patient, graft, path_length_mm);
  const auto directions = directions_of(seat);
  std::vector<InsertionPath> paths(directions.size());
  parallel_for(directions.size(), threads,
               [&](std::size_t i) { paths[i] = examine(around, directions[i]); });
  InsertionPath best;
  for (std::size_t i = 0; i < paths.size(); ++i)
    if (i == 0 || is_better(paths[i], best)) best = paths[i];
  best.directions = static_cast<int>(directions.size());
  if (best.state != InsertionPath::State::blocked) return best;
  const TurnedPath turned =
      find_turned_path(patient, seat, graft, directions, path_length_mm, threads);
  best.poses_examined = turned.examined;
  best.searched_mm = turned.farthest_mm;
  if (turned.poses.empty()) return best;
  InsertionPath found = examine_turned(around, turned.poses, threads);
  found.directions = best.directions;
  found.poses_examined = turned.examined;
  found.searched_mm = turned.farthest_mm;
  return found;
}

std::string state_name(InsertionPath::State state) {
  return state == InsertionPath::State::free    ? "free"
         : state == InsertionPath::State::tight ? "tight"
                                                : "blocked";
}

std::string insertion_path_text(const InsertionPath& path, const Seat& seat) {
  const std::string where = fmt::format("({:.1f}, {:.1f}, {:.1f})", path.margin_at.x(),
                                        path.margin_at.y(), path.margin_at.z());
  if (path.state == InsertionPath::State::blocked)
    return fmt::format(
        "insertion path of {}: blocked; {}; on paths with turns ({} poses examined) its centre "
        "moves {:.1f} mm away from the seat",
        seat.name,
        path.blocked_by.empty()
            ? "no straight direction leads out between the faces of the bone"
            : fmt::format(
                  "of {} straight directions the best ({}) withdraws the graft by {:.2f} mm, "
                  "where it meets {} at {}",
                  path.directions, direction_words(path.direction), path.blocked_after_mm,
                  path.blocked_by, where),
        path.poses_examined, path.searched_mm);
  std::string text = fmt::format(
      "insertion path of {}: {}, {} (out of its seat {})", seat.name, state_name(path.state),
      path.turns() ? fmt::format("turned by up to {:.0f} degrees over {:.0f} mm", path.turn_deg,
                                 path.length_mm)
                   : "straight",
      direction_words(path.direction));
  if (path.margin_part.empty())
    return text + fmt::format("; more than {:g} mm from all else", farthest_mm);
  return text + fmt::format("; least distance {:.2f} mm, {:.1f} mm from the seat, to {} at {}",
                            path.margin_mm, path.margin_after_mm, path.margin_part, where);
}

}  // namespace condyle
