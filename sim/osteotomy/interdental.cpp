#include "sim/osteotomy/interdental.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/osteotomy/danger_zones.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double per_degree = 3.14159265358979323846 / 180;

double farthest(const std::vector<Vector3d>& points, const Vector3d& along, double start) {
  for (const Vector3d& p : points) start = std::max(start, along.dot(p));
  return start;
}

/// The best plane of one direction, and its distances.
InterdentalPlane plane_along(const NeighbourTooth& first, const NeighbourTooth& second,
                             const Vector3d& normal) {
  constexpr double none = -1e9;
  // Where the first tooth ends and the second begins.
  const double root_end = farthest(first.root, normal, none),
               root_start = -farthest(second.root, -normal, none),
               crown_end = farthest(first.crown, normal, none),
               crown_start = -farthest(second.crown, -normal, none);
  const bool has_roots = !first.root.empty() && !second.root.empty();
  double at = 0.5 * (has_roots ? root_end + root_start : crown_end + crown_start);
  at = crown_end <= crown_start ? std::clamp(at, crown_end, crown_start)
                                : 0.5 * (crown_end + crown_start);
  return {.point = at * normal,
          .normal = normal,
          .root_mm = has_roots ? std::min(at - root_end, root_start - at)
                               : std::numeric_limits<double>::infinity(),
          .crown_mm = std::min(at - crown_end, crown_start - at)};
}

/// A crown that is cut counts ten times.
double value_of(const InterdentalPlane& plane) {
  return std::min(plane.root_mm, 100.0) + 10 * std::min(0.0, plane.crown_mm);
}

}  // namespace

NeighbourTooth split_tooth(std::vector<Vector3d> points, const TriangleTree& bone) {
  const auto before = [](const Vector3d& a, const Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<Vector3d> inside;
  Vector3d sum_inside = Vector3d::Zero(), sum = Vector3d::Zero();
  for (const Vector3d& p : points) {
    sum += p;
    if (bone.empty() || bone.signed_nearest(p).distance >= 0) continue;
    inside.push_back(p);
    sum_inside += p;
  }
  const std::size_t outside = points.size() - inside.size();
  if (10 * inside.size() < points.size() || outside == 0) return {{}, std::move(points)};
  const Vector3d along = (sum_inside / static_cast<double>(inside.size()) -
                          (sum - sum_inside) / static_cast<double>(outside))
                             .normalized();
  double crest = std::numeric_limits<double>::infinity();
  for (const Vector3d& p : inside) crest = std::min(crest, along.dot(p));
  NeighbourTooth tooth;
  for (const Vector3d& p : points)
    (along.dot(p) > crest + crest_mm ? tooth.root : tooth.crown).push_back(p);
  return tooth;
}

std::optional<InterdentalPlane> find_interdental(const SurgicalAnatomy& jaw, int first,
                                                 int second) {
  const auto from = jaw.tooth_middle(first), to = jaw.tooth_middle(second);
  if (!from || !to) return std::nullopt;
  Vector3d along = *to - *from;
  along.z() = 0;
  if (!(along.norm() > 0.1)) return std::nullopt;
  along.normalize();
  const Vector3d across = Vector3d::UnitZ().cross(along);
  const TriangleTree bone(jaw.bone());
  const NeighbourTooth a = split_tooth(jaw.tooth_points(first), bone),
                       b = split_tooth(jaw.tooth_points(second), bone);
  const auto plane_at = [&](double turn, double tilt) {
    return plane_along(a, b,
                       (along + std::tan(turn * per_degree) * across +
                        std::tan(tilt * per_degree) * Vector3d::UnitZ())
                           .normalized());
  };
  constexpr double most_turn = 20, most_tilt = 15;
  double turn = 0, tilt = 0;
  InterdentalPlane best = plane_at(0, 0);
  const auto try_at = [&](double new_turn, double new_tilt) {
    if (std::abs(new_turn) > most_turn || std::abs(new_tilt) > most_tilt) return;
    const InterdentalPlane plane = plane_at(new_turn, new_tilt);
    if (value_of(plane) > value_of(best)) best = plane, turn = new_turn, tilt = new_tilt;
  };
  for (double i = -most_turn; i <= most_turn; i += 4)
    for (double k = -most_tilt; k <= most_tilt; k += 3) try_at(i, k);
  for (const double step : {2.0, 1.0, 0.5, 0.25}) {
    const double middle_turn = turn, middle_tilt = tilt;
    for (int i = -2; i <= 2; ++i)
      for (int k = -2; k <= 2; ++k) try_at(middle_turn + i * step, middle_tilt + k * step);
  }
  best.first = first;
  best.second = second;
  // Through the middle of the two teeth.
  const Vector3d middle = 0.5 * (*from + *to);
  best.point = middle + (best.point.dot(best.normal) - middle.dot(best.normal)) * best.normal;
  return best;
}

std::string room_text(const InterdentalPlane& plane, double kerf_mm) {
  const double bone = DangerMargins{}.interdental.warn_mm;
  std::string text = fmt::format("teeth {} and {}: ", plane.first, plane.second);
  if (!std::isfinite(plane.root_mm))
    return text + "their roots are not known; the cut runs between the crowns";
  text += fmt::format(
      "more than {:g} mm from the crest, their roots leave {:.1f} mm for the cut; {:g} mm of bone "
      "on each root{} {:.1f} mm",
      crest_mm, std::max(0.0, 2 * plane.root_mm), bone,
      kerf_mm > 0 ? " and the saw require" : " requires", 2 * bone + kerf_mm);
  if (plane.crown_mm - 0.5 * kerf_mm < 0)
    text += fmt::format("; their crowns touch, and reach up to {:.1f} mm beyond the cut",
                        0.5 * kerf_mm - plane.crown_mm);
  return text;
}

}  // namespace condyle
