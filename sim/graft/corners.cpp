#include "sim/graft/corners.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle {
namespace {

using Eigen::Vector3d;

double squared_distance(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double s = std::clamp((p - a).dot(along) / along.squaredNorm(), 0., 1.);
  return (p - a - s * along).squaredNorm();
}

/// Points of a polyline at equal distances along it.
std::vector<Vector3d> resampled(const std::vector<Vector3d>& curve, int intervals) {
  std::vector<double> at = {0};
  for (std::size_t i = 1; i < curve.size(); ++i)
    at.push_back(at.back() + (curve[i] - curve[i - 1]).norm());
  std::vector<Vector3d> points;
  std::size_t line = 1;
  for (int k = 0; k <= intervals; ++k) {
    const double s = at.back() * k / intervals;
    while (line + 1 < at.size() && at[line] < s) ++line;
    const double share = std::clamp((s - at[line - 1]) / (at[line] - at[line - 1]), 0., 1.);
    points.push_back(curve[line - 1] + share * (curve[line] - curve[line - 1]));
  }
  return points;
}

/// Dynamic programming over the points of the curve; empty where no choice has long enough pieces.
std::vector<Vector3d> best_corners(const std::vector<Vector3d>& points, int pieces,
                                   double least_mm) {
  const std::size_t n = points.size();
  constexpr double none = std::numeric_limits<double>::infinity();
  const auto cost_of = [&](std::size_t from, std::size_t to) {
    if ((points[to] - points[from]).norm() < least_mm) return none;
    constexpr double even_lengths = 1e-6;  // decides where the curve is straight
    double sum = even_lengths * (points[to] - points[from]).squaredNorm();
    for (std::size_t k = from + 1; k < to; ++k)
      sum += squared_distance(points[k], points[from], points[to]);
    return sum;
  };
  std::vector<double> best(n, none);
  best[0] = 0;
  std::vector<std::vector<std::size_t>> from;
  for (int piece = 0; piece < pieces; ++piece) {
    std::vector<double> next(n, none);
    std::vector<std::size_t> chosen(n, 0);
    for (std::size_t to = 1; to < n; ++to)
      for (std::size_t i = 0; i < to; ++i) {
        if (best[i] == none) continue;
        if (const double cost = best[i] + cost_of(i, to); cost < next[to]) {
          next[to] = cost;
          chosen[to] = i;
        }
      }
    best = std::move(next);
    from.push_back(std::move(chosen));
  }
  if (best[n - 1] == none) return {};
  std::vector<Vector3d> corners = {points[n - 1]};
  std::size_t at = n - 1;
  for (int piece = pieces - 1; piece >= 0; --piece) {
    at = from[static_cast<std::size_t>(piece)][at];
    corners.push_back(points[at]);
  }
  std::reverse(corners.begin(), corners.end());
  return corners;
}

}  // namespace

std::vector<Vector3d> corners_on_curve(const std::vector<Vector3d>& curve, int pieces,
                                       double least_mm) {
  constexpr int intervals = 60;
  if (curve.size() == static_cast<std::size_t>(pieces) + 1) return curve;
  const auto points = resampled(curve, intervals);
  // A curve that is too short for the least length is divided almost evenly.
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  for (const double least : {least_mm, 0.9 * length / pieces, 0.5 * length / pieces})
    if (auto corners = best_corners(points, pieces, least); !corners.empty()) return corners;
  return best_corners(points, pieces, 0);
}

double deviation_of(const std::vector<Vector3d>& corners, const std::vector<Vector3d>& curve) {
  double most = 0;
  for (const Vector3d& p : curve) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < corners.size(); ++i)
      least = std::min(least, squared_distance(p, corners[i - 1], corners[i]));
    most = std::max(most, least);
  }
  return std::sqrt(most);
}

}  // namespace condyle
