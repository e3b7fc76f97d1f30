#include "sim/dental_scan/scanned_bite.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "engine/registration/surface_samples.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double deepest_mm = 0.3, farthest_mm = 0.5;  // between crowns in contact
constexpr double place_mm = 5;                         // places are cells of this size
constexpr int places_a_side = 3;
constexpr double overlap_mm = 0.6, overlap_reach_mm = 4;
constexpr double overlap_fraction = 0.01;

}  // namespace

ScannedBite scanned_bite(const TriMesh& upper, const TriMesh& lower, const Pose& X_CU,
                         double midline_mm) {
  constexpr int count = 6000;
  ScannedBite bite;
  const SurfacePairs surface(upper);
  const CrownPoints crowns = crown_points(lower, X_CU.R.conjugate() * Vector3d::UnitZ(), count);
  std::set<std::pair<int, int>> left, right;
  int inside = 0;
  for (std::size_t i = 0; i < crowns.points.size(); ++i) {
    const Vector3d& p = crowns.points.points[i];
    const SurfacePoint near = surface.tree().signed_nearest(p, overlap_reach_mm);
    if (near.triangle < 0) continue;
    if (near.distance < -overlap_mm && surface.find(p, surface.tree().pseudonormal(near))) ++inside;
    const auto facing = surface.find(p, -crowns.points.normals[i]);
    if (!facing || facing->distance < -deepest_mm || facing->distance > farthest_mm) continue;
    const Vector3d place = X_CU * p;
    auto& side = place.x() > midline_mm ? left : right;
    side.emplace(static_cast<int>(std::floor(place.x() / place_mm)),
                 static_cast<int>(std::floor(place.y() / place_mm)));
  }
  bite.left = static_cast<int>(left.size());
  bite.right = static_cast<int>(right.size());
  if (crowns.points.size() > 0)
    bite.overlapping = static_cast<double>(inside) / static_cast<double>(crowns.points.size());
  if (bite.overlapping > overlap_fraction)
    bite.why = fmt::format("{:.0f} % of the lower crowns lie deep in the upper ones",
                           100 * bite.overlapping);
  else if (std::min(bite.left, bite.right) < places_a_side)
    bite.why = fmt::format("the crowns face each other closely at {} places left and {} right",
                           bite.left, bite.right);
  bite.in_occlusion = bite.why.empty();
  return bite;
}

BiteError bite_error(const ArchFit& upper, const ArchFit& lower, const ArchTarget& lower_target) {
  BiteError error;
  error.X_CM = upper.X_CS * lower.X_CS.inverse();
  for (const auto& mark : lower_target.marks())
    error.largest_mm = std::max(error.largest_mm, (error.X_CM * mark - mark).norm());
  error.rotation_deg = rotation_angle(error.X_CM) * 180 / std::numbers::pi;
  return error;
}

}  // namespace condyle
