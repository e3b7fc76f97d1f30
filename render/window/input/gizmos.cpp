#include "render/window/input/gizmos.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array arrows = {Grip::left, Grip::back, Grip::up};
constexpr std::array rings = {Grip::turn_left, Grip::turn_back, Grip::turn_up};

int axis_of(Grip grip) {
  switch (grip) {
    case Grip::left:
    case Grip::turn_left:
      return 0;
    case Grip::back:
    case Grip::turn_back:
      return 1;
    default:
      return 2;
  }
}

/// Width of one pixel at this depth, mm.
double pixel_at(const GizmoView& view) {
  const Eigen::Matrix3d axes = picture_axes(view.camera);
  const double depth = view.camera.distance_mm - axes.row(2).dot(view.center - view.camera.target);
  return std::max(depth, 1.0) * 2 *
         std::tan(view.camera.field_of_view_deg * std::numbers::pi / 360) / view.view.height;
}

double distance_to(const Vector2d& p, const std::vector<Vector2d>& line) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector2d along = line[i + 1] - line[i];
    const double s =
        std::clamp((p - line[i]).dot(along) / std::max(along.squaredNorm(), 1e-12), 0.0, 1.0);
    least = std::min(least, (p - line[i] - s * along).norm());
  }
  return least;
}

}  // namespace

Vector2d screen_place(const Camera& camera, const ViewRect& view, const Vector3d& p) {
  const Vector3d q = picture_axes(camera) * (p - camera.target);
  const double depth = std::max(camera.distance_mm - q.z(), 1e-3);
  const double pixels =
      view.height / 2 / std::tan(camera.field_of_view_deg * std::numbers::pi / 360) / depth;
  return {view.x + view.width / 2 + pixels * q.x(), view.y + view.height / 2 - pixels * q.y()};
}

std::vector<GizmoHandle> gizmo_handles(const GizmoView& view) {
  const double mm = pixel_at(view);
  const auto place = [&](const Vector3d& p) { return screen_place(view.camera, view.view, p); };
  std::vector<GizmoHandle> all;
  for (const Grip grip : arrows)
    all.push_back({grip,
                   {place(view.center),
                    place(view.center + view.arrow_px * mm * view.axes.col(axis_of(grip)))}});
  for (const Grip grip : rings) {
    const int axis = axis_of(grip);
    const Vector3d u = view.axes.col((axis + 1) % 3), v = view.axes.col((axis + 2) % 3);
    constexpr int pieces = 48;
    GizmoHandle ring{grip, {}};
    for (int i = 0; i <= pieces; ++i) {
      const double a = 2 * std::numbers::pi * i / pieces;
      ring.line.push_back(
          place(view.center + view.ring_px * mm * (std::cos(a) * u + std::sin(a) * v)));
    }
    all.push_back(std::move(ring));
  }
  return all;
}

std::optional<Grip> grip_at(const GizmoView& view, const Vector2d& mouse, double reach_px) {
  const auto all = gizmo_handles(view);
  std::optional<Grip> found;
  double nearest = reach_px;
  for (const bool arrow : {true, false}) {
    for (const auto& handle : all) {
      if ((handle.line.size() == 2) != arrow) continue;
      // Near the centre, where all arrows meet, the body itself is gripped.
      std::vector<Vector2d> line = handle.line;
      if (arrow) line[0] += 0.3 * (line[1] - line[0]);
      const double distance = distance_to(mouse, line);
      if (distance >= nearest) continue;
      nearest = distance;
      found = handle.grip;
    }
    if (found) return found;
  }
  return std::nullopt;
}

Pose gripped(const GizmoView& view, Grip grip, const Pose& start, const Vector2d& from,
             const Vector2d& to) {
  const Eigen::Matrix3d axes = picture_axes(view.camera);
  const double mm = pixel_at(view);
  const Vector2d moved = to - from;
  if (grip == Grip::body) {
    const Vector3d shift = mm * (moved.x() * axes.row(0) - moved.y() * axes.row(1)).transpose();
    return {start.R, start.t + shift};
  }
  const Vector3d axis = view.axes.col(axis_of(grip));
  const Vector2d center = screen_place(view.camera, view.view, view.center);
  if (std::find(arrows.begin(), arrows.end(), grip) != arrows.end()) {
    // Pixels per mm along the axis; an arrow toward the eye moves at most tenfold.
    const Vector2d per_mm = (screen_place(view.camera, view.view, view.center + 0.5 * axis) -
                             screen_place(view.camera, view.view, view.center - 0.5 * axis));
    const double least = 0.01 / (mm * mm);
    return {start.R, start.t + axis * (moved.dot(per_mm) / std::max(per_mm.squaredNorm(), least))};
  }
  // About the centre on the screen; a ring seen from its back turns in the opposite direction.
  const Vector2d a = from - center, b = to - center;
  double angle = 0;
  const double facing = axes.row(2).dot(axis);
  if (std::abs(facing) > 0.3) {
    // y points down on the screen.
    angle = -std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) * (facing > 0 ? 1 : -1);
  } else {
    // Viewed edge-on: like a wheel rolled across its axis.
    const Vector2d along = (axes.topRows<2>() * axis).cwiseProduct(Vector2d(1, -1)).normalized();
    const Vector2d across(-along.y(), along.x());
    angle = moved.dot(across) / view.ring_px;
  }
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, axis));
  return Pose{turn, view.center - turn * view.center} * start;
}

}  // namespace condyle
