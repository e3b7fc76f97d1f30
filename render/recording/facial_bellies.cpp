#include "render/recording/facial_bellies.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/recording/muscle_looks.h"
#include "render/recording/strap.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> places_of(const TissueMuscles::Line& line, const TissueState& now,
                                std::span<const Pose> X_CB) {
  std::vector<Vector3d> places;
  for (const TissueMuscles::Point& point : line.points)
    places.push_back(point.bone ? Vector3d(pose_in(X_CB, *point.bone) * point.rest)
                                : point.carried.at(now.nodes));
  return places;
}

void add_strap(FibreBody& body, std::vector<Vector3d> places, const Vector3d& axis,
               double half_width, double half_thick) {
  const bool loop = (places.front() - places.back()).norm() < 1e-6;
  if (loop) places.pop_back();
  const auto n = static_cast<int>(places.size());
  const int first = static_cast<int>(body.positions.size());
  const Eigen::Vector3f color = muscle_color(MuscleAction::facial, 0);
  const auto at = [&](int i) -> const Vector3d& {
    return places[static_cast<std::size_t>(loop ? (i + n) % n : std::clamp(i, 0, n - 1))];
  };
  for (int i = 0; i < n; ++i) {
    const double end = loop ? 1 : std::min(i, n - 1 - i) == 0 ? 0.35 : 1;
    const Vector3d along = (at(i + 1) - at(i - 1)).normalized();
    Vector3d out = at(i) - axis;
    out.z() = 0;
    out = (out - out.dot(along) * along).normalized();
    const Vector3d wide = along.cross(out);
    for (int side = 0; side < strap_sides; ++side) {
      const Eigen::Vector2d p = strap_side(side);
      body.positions.push_back(
          (at(i) + end * (p.x() * half_width * wide + p.y() * half_thick * out)).cast<float>());
      body.fibres.push_back(fibre_of(side, 2 * half_width));
      body.colors.push_back(end < 1 ? tendon_color : color);
    }
  }
  add_strap_triangles(body, first, n, loop);
  if (loop) return;
  for (const Vector3d& place : {places.front(), places.back()}) {
    body.positions.push_back(place.cast<float>());
    body.fibres.push_back(0);
    body.colors.push_back(tendon_color);
  }
}

}  // namespace

FibreBody facial_bellies(const TissueModel& model, const TissueState& now) {
  constexpr double flatness = 2.5;
  FibreBody body;
  const std::vector<Pose> X_CB = poses_from_mesh(model, now.X_CB);
  Vector3d axis = Vector3d::Zero();  // on the vertical one of the tissue
  for (const Vector3d& node : now.nodes) axis += node / static_cast<double>(now.nodes.size());
  for (const TissueMuscles::Line& line : model.muscles.lines) {
    const std::vector<Vector3d> places = places_of(line, now, X_CB);
    if (places.size() < 2) continue;
    double length = 0;
    for (std::size_t i = 1; i < places.size(); ++i) length += (places[i] - places[i - 1]).norm();
    // Of constant volume.
    const double area = belly_area_mm2(line.limit_N) * line.rest_mm / std::max(length, 1.0);
    const double half_thick = std::sqrt(area / (std::numbers::pi * flatness));
    add_strap(body, places, axis, flatness * half_thick, half_thick);
  }
  return body;
}

}  // namespace condyle
