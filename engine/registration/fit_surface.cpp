#include "engine/registration/fit_surface.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "engine/core/infinity.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Vector3d normal_at(const TriangleTree& tree, int triangle) {
  const auto& c = tree.corners(triangle);
  return (c[1] - c[0]).cross(c[2] - c[0]).normalized();
}

/// Keeps the nearest of the pairs from `first` on and gives them weights.
void trim(std::vector<SurfaceMatch>& matches, std::size_t first, const MatchSettings& settings) {
  std::vector<double> distances;
  for (std::size_t i = first; i < matches.size(); ++i) distances.push_back(matches[i].distance);
  if (distances.empty()) return;
  const auto last =
      static_cast<std::size_t>(settings.kept * (static_cast<double>(distances.size()) - 1));
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(last),
                   distances.end());
  const double limit = std::min(distances[last], settings.farthest_mm);
  std::size_t kept = first;
  for (std::size_t i = first; i < matches.size(); ++i) {
    if (matches[i].distance > limit) continue;
    const double far = matches[i].distance / settings.soft_mm;
    matches[i].weight /= 1 + far * far;
    matches[kept++] = matches[i];
  }
  matches.resize(kept);
}

/// Appends those that were found.
void append(std::vector<SurfaceMatch>& matches, std::vector<std::optional<SurfaceMatch>>& found) {
  for (auto& match : found)
    if (match) matches.push_back(*match);
}

std::optional<SurfaceMatch> forward_match(int sample, double weight, const Vector3d& from,
                                          const Vector3d& now, const Vector3d& normal,
                                          const FitSurface& target, const MatchSettings& settings) {
  const auto pair = target.pairs.find(now, normal);
  if (!pair || pair->normal.dot(normal) < settings.cos_normals) return std::nullopt;
  return SurfaceMatch{sample, from, now, pair->point, pair->normal, std::abs(pair->distance),
                      weight};
}

}  // namespace

OtherDistances distances_to(const TriangleTree& other, const FitSurface& target, int threads) {
  OtherDistances distances(target.samples.size());
  parallel_for(distances.size(), threads, [&](std::size_t i) {
    const auto& sample = target.samples[i];
    const SurfacePoint near = other.nearest(sample.point);
    const bool alike =
        near.triangle >= 0 && normal_at(other, near.triangle).dot(sample.normal) > 0.3;
    distances[i] = alike ? near.distance : infinity;
  });
  return distances;
}

FitSurface::FitSurface(TriMesh surface, int sample_count, int threads)
    : mesh(std::move(surface)),
      pairs(mesh),
      samples(outer_samples(sample_surface(mesh, sample_count), pairs.tree(), threads)) {}

std::vector<SurfaceMatch> match_surfaces(const FitSurface& moving, const AffineMap& map,
                                         const FitSurface& target, const MatchSettings& settings,
                                         const OtherDistances& other) {
  const AffineMap back = map.inverse();
  const Eigen::Matrix3d turn = back.matrix.transpose(), turn_back = map.matrix.transpose();
  std::vector<std::optional<SurfaceMatch>> found(moving.samples.size() / settings.stride);
  parallel_for(found.size(), settings.threads, [&](std::size_t k) {
    const std::size_t i = k * settings.stride;
    const auto& sample = moving.samples[i];
    found[k] =
        forward_match(static_cast<int>(i), moving.weight_of(sample.triangle), sample.point,
                      map * sample.point, (turn * sample.normal).normalized(), target, settings);
  });
  std::vector<SurfaceMatch> matches;
  append(matches, found);
  trim(matches, 0, settings);
  found.assign(target.samples.size() / settings.stride, std::nullopt);
  const TriangleTree& tree = moving.pairs.tree();
  parallel_for(found.size(), settings.threads, [&](std::size_t k) {
    const std::size_t i = k * settings.stride;
    const auto& sample = target.samples[i];
    const SurfacePoint near = tree.nearest(back * sample.point);
    const Vector3d normal = (turn_back * sample.normal).normalized();
    if (near.triangle < 0 || normal_at(tree, near.triangle).dot(normal) < settings.cos_normals)
      return;
    const Vector3d now = map * near.point;
    const double distance = (now - sample.point).norm();
    if (!other.empty() && other[i] < distance) return;
    found[k] = SurfaceMatch{-1,
                            near.point,
                            now,
                            sample.point,
                            sample.normal,
                            distance,
                            moving.weight_of(near.triangle)};
  });
  const std::size_t first = matches.size();
  append(matches, found);
  trim(matches, first, settings);
  return matches;
}

std::vector<SurfaceMatch> match_surfaces(const FitSurface& moving,
                                         const std::vector<Vector3d>& carried,
                                         const TriangleTree& tree, const FitSurface& target,
                                         const MatchSettings& settings,
                                         const OtherDistances& other) {
  std::vector<std::optional<SurfaceMatch>> found(moving.samples.size());
  const auto at = [&](int triangle, int corner) -> const Vector3d& {
    return carried[static_cast<std::size_t>(
        moving.mesh.triangles[static_cast<std::size_t>(triangle)][corner])];
  };
  parallel_for(found.size(), settings.threads, [&](std::size_t i) {
    const auto& sample = moving.samples[i];
    const Vector3d &a = at(sample.triangle, 0), &b = at(sample.triangle, 1),
                   &c = at(sample.triangle, 2);
    const Vector3d &share = sample.barycentric, now = share[0] * a + share[1] * b + share[2] * c;
    found[i] = forward_match(static_cast<int>(i), moving.weight_of(sample.triangle), sample.point,
                             now, (b - a).cross(c - a).normalized(), target, settings);
  });
  std::vector<SurfaceMatch> matches;
  append(matches, found);
  trim(matches, 0, settings);
  found.assign(target.samples.size(), std::nullopt);
  parallel_for(found.size(), settings.threads, [&](std::size_t i) {
    const auto& sample = target.samples[i];
    const SurfacePoint near = tree.nearest(sample.point, settings.farthest_mm);
    if (near.triangle < 0) return;
    const Vector3d &a = at(near.triangle, 0), &b = at(near.triangle, 1), &c = at(near.triangle, 2);
    if ((b - a).cross(c - a).normalized().dot(sample.normal) < settings.cos_normals) return;
    if (!other.empty() && other[i] < near.distance) return;
    found[i] = SurfaceMatch{-1,
                            near.point,
                            near.point,
                            sample.point,
                            sample.normal,
                            near.distance,
                            moving.weight_of(near.triangle)};
  });
  const std::size_t first = matches.size();
  append(matches, found);
  trim(matches, first, settings);
  return matches;
}

std::vector<char> explained_samples(const FitSurface& target, const AffineMap& map,
                                    const FitSurface& moving, double near_mm, int threads,
                                    std::size_t stride) {
  constexpr double cos_normals = 0.5;
  const AffineMap back = map.inverse();
  const double scale = std::cbrt(std::abs(back.matrix.determinant()));
  const TriangleTree& tree = moving.pairs.tree();
  std::vector<char> near(target.samples.size() / stride);
  parallel_for(near.size(), threads, [&](std::size_t i) {
    const auto& sample = target.samples[i * stride];
    const SurfacePoint found = tree.nearest(back * sample.point, near_mm * scale);
    if (found.triangle < 0) return;
    const Vector3d normal = (map.matrix.transpose() * sample.normal).normalized();
    near[i] = normal_at(tree, found.triangle).dot(normal) > cos_normals ? 1 : 0;
  });
  return near;
}

double explained_share(const FitSurface& target, const AffineMap& map, const FitSurface& moving,
                       double near_mm, int threads, std::size_t stride) {
  const auto near = explained_samples(target, map, moving, near_mm, threads, stride);
  if (near.empty()) return 0;
  return static_cast<double>(std::count(near.begin(), near.end(), 1)) /
         static_cast<double>(near.size());
}

}  // namespace condyle
