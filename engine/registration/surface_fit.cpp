#include "engine/registration/surface_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "engine/core/parallel.h"
#include "engine/registration/rigid_fit.h"

namespace condyle {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The nearest `kept` of the pairs, in the order of the points.
std::vector<std::size_t> trimmed(const std::vector<std::optional<SurfacePair>>& pairs,
                                 double kept) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (pairs[i]) found.push_back(i);
  std::stable_sort(found.begin(), found.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(pairs[a]->distance) < std::abs(pairs[b]->distance);
  });
  found.resize(static_cast<std::size_t>(kept * static_cast<double>(found.size())));
  std::sort(found.begin(), found.end());
  return found;
}

/// The small motion, rotation about `center` and translation, that takes the points to the tangent
/// planes of their partners.
Vector6 step_of(const std::vector<Eigen::Vector3d>& p_B,
                const std::vector<std::optional<SurfacePair>>& pairs,
                const std::vector<std::size_t>& used, const Eigen::Vector3d& center) {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (const std::size_t i : used) {
    const SurfacePair& pair = *pairs[i];
    Vector6 row;
    row << (p_B[i] - center).cross(pair.normal), pair.normal;
    matrix += row * row.transpose();
    right -= pair.normal.dot(p_B[i] - pair.point) * row;
  }
  // Along directions that the surface leaves free, as about a sphere's centre, nothing moves.
  matrix.diagonal() += 1e-9 * matrix.diagonal();
  return matrix.ldlt().solve(right);
}

}  // namespace

SurfaceFit fit_to_surface(std::span<const Eigen::Vector3d> p_A,
                          std::span<const Eigen::Vector3d> normals_A, const SurfacePairs& surface_B,
                          const Pose& start, const SurfaceFitSettings& settings) {
  constexpr std::size_t fewest = 30;
  assert(p_A.size() == normals_A.size());
  SurfaceFit fit;
  fit.X_BA = start;
  std::vector<Eigen::Vector3d> p_B(p_A.size());
  std::vector<std::optional<SurfacePair>> pairs(p_A.size());
  for (; fit.iterations <= settings.max_iterations; ++fit.iterations) {
    parallel_for(p_A.size(), settings.threads, [&](std::size_t i) {
      p_B[i] = fit.X_BA * p_A[i];
      const Eigen::Vector3d normal = fit.X_BA.R * normals_A[i];
      pairs[i] = surface_B.find(p_B[i], normal, settings.least_cos);
      if (settings.planes_of_points && pairs[i]) pairs[i]->normal = normal;
    });
    const bool whole = fit.iterations < settings.point_rounds;
    const auto used = trimmed(pairs, whole ? settings.kept_first : settings.kept);
    fit.pairs = static_cast<int>(used.size());
    if (used.size() < fewest) return fit;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double squares = 0;
    for (const std::size_t i : used) {
      center += p_B[i] / static_cast<double>(used.size());
      squares += pairs[i]->distance * pairs[i]->distance;
    }
    fit.rms_mm = std::sqrt(squares / static_cast<double>(used.size()));
    if (fit.converged || fit.iterations == settings.max_iterations) return fit;
    if (whole) {
      std::vector<Eigen::Vector3d> from, to;
      for (const std::size_t i : used) from.push_back(p_B[i]), to.push_back(pairs[i]->point);
      if (const auto moved = rigid_fit(from, to)) fit.X_BA = *moved * fit.X_BA;
      continue;
    }
    const Vector6 step = step_of(p_B, pairs, used, center);
    if (!step.allFinite()) return fit;
    double radius = 0;
    for (const std::size_t i : used) radius = std::max(radius, (p_B[i] - center).norm());
    const double angle = step.head<3>().norm();
    Pose moved;
    if (angle > 0) moved.R = Eigen::AngleAxisd(angle, step.head<3>() / angle);
    moved.t = center + step.tail<3>() - moved.R * center;
    fit.X_BA = moved * fit.X_BA;
    fit.converged = angle * radius + step.tail<3>().norm() < settings.small_mm;
  }
  return fit;
}

}  // namespace condyle
