#include "engine/registration/best_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

/// Fits of the same points from several starts, the least residual first.
std::vector<RankedPose> race(const OrientedPoints& points, const SurfacePairs& surface,
                             std::span<const Pose> starts, const BestFitSettings& settings,
                             int point_rounds) {
  std::vector<RankedPose> fitted(starts.size());
  SurfaceFitSettings each = settings.fit;
  each.point_rounds = point_rounds;
  each.max_iterations = point_rounds + settings.rounds;
  each.threads = 1;
  parallel_for(starts.size(), settings.fit.threads, [&](std::size_t i) {
    fitted[i].X_BA = fit_to_surface(points.points, points.normals, surface, starts[i], each).X_BA;
    fitted[i].residual_mm =
        surface_residual(points, surface, fitted[i].X_BA, settings.far_mm, each).trimmed_mean_mm;
  });
  std::stable_sort(fitted.begin(), fitted.end(), [](const RankedPose& a, const RankedPose& b) {
    return a.residual_mm < b.residual_mm;
  });
  return fitted;
}

}  // namespace

OrientedPoints OrientedPoints::thinned(std::size_t count) const {
  if (size() <= count) return *this;
  OrientedPoints kept;
  for (std::size_t i = 0; i < count; ++i) {
    kept.points.push_back(points[i * size() / count]);
    kept.normals.push_back(normals[i * size() / count]);
  }
  return kept;
}

SurfaceResidual surface_residual(const OrientedPoints& points_A, const SurfacePairs& surface_B,
                                 const Pose& X_BA, double far_mm, const SurfaceFitSettings& fit) {
  SurfaceResidual residual;
  const std::size_t count = points_A.size();
  if (count == 0) return residual;
  std::vector<double> distance(count, far_mm), nearest(count, far_mm);
  std::vector<char> partner(count);
  parallel_for(count, fit.threads, [&](std::size_t i) {
    nearest[i] =
        std::min(far_mm, surface_B.tree().nearest(X_BA * points_A.points[i], far_mm).distance);
    const auto pair =
        surface_B.find(X_BA * points_A.points[i], X_BA.R * points_A.normals[i], fit.least_cos);
    if (!pair) return;
    partner[i] = 1;
    distance[i] = std::min(far_mm, std::abs(pair->distance));
  });
  const auto found = std::count(partner.begin(), partner.end(), 1);
  residual.without_partner = 1 - static_cast<double>(found) / static_cast<double>(count);
  std::sort(distance.begin(), distance.end());
  std::sort(nearest.begin(), nearest.end());
  const auto at = [&](double fraction) {
    return nearest[std::min(count - 1,
                            static_cast<std::size_t>(fraction * static_cast<double>(count)))];
  };
  residual.median_mm = at(0.5);
  residual.p95_mm = at(0.95);
  const std::size_t used =
      std::max<std::size_t>(1, static_cast<std::size_t>(fit.kept * static_cast<double>(count)));
  residual.trimmed_mean_mm =
      std::accumulate(distance.begin(), distance.begin() + static_cast<std::ptrdiff_t>(used), 0.0) /
      static_cast<double>(used);
  return residual;
}

std::vector<Pose> poses_about(const Pose& X_BA, const Eigen::Vector3d& center_A, double angle_rad,
                              double shift_mm) {
  std::vector<Pose> poses;
  const Eigen::Vector3d center = X_BA * center_A;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d axis(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    const Eigen::Vector3d shift(axis.y(), axis.z(), -axis.x());
    Pose turn;
    turn.R = Eigen::AngleAxisd(angle_rad, axis.normalized());
    turn.t = center + shift_mm * shift.normalized() - turn.R * center;
    poses.push_back(turn * X_BA);
  }
  return poses;
}

std::vector<RankedPose> rank_starts(const OrientedPoints& points_A, const SurfacePairs& surface_B,
                                    std::span<const Pose> starts, const BestFitSettings& settings) {
  const auto first = race(points_A.thinned(settings.few_points), surface_B, starts, settings,
                          settings.point_rounds);
  std::vector<Pose> best;
  for (const RankedPose& ranked : first)
    if (best.size() < settings.refined) best.push_back(ranked.X_BA);
  return race(points_A.thinned(settings.more_points), surface_B, best, settings, 0);
}

BestFit best_fit_to_surface(const OrientedPoints& points_A, const SurfacePairs& surface_B,
                            const Pose& start, const BestFitSettings& settings,
                            std::span<const Pose> further) {
  BestFit best;
  if (points_A.size() == 0) return best;
  const OrientedPoints more = points_A.thinned(settings.more_points);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const auto& p : more.points) center += p / static_cast<double>(more.size());
  std::vector<Pose> starts = poses_about(start, center, settings.angle_rad, settings.shift_mm);
  starts.insert(starts.begin(), start);
  starts.insert(starts.end(), further.begin(), further.end());
  const Pose found = race(more, surface_B, starts, settings, 0).front().X_BA;
  best.fit = fit_to_surface(points_A.points, points_A.normals, surface_B, found, settings.fit);
  best.residual =
      surface_residual(points_A, surface_B, best.fit.X_BA, settings.far_mm, settings.fit);
  return best;
}

}  // namespace condyle
