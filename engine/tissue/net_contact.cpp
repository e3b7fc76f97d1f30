#include "engine/tissue/net_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double band_mm = 2.0;
/// The error is an eighth of the spacing's square times the curvature: 0.01 mm on a crown.
constexpr double spacing_mm = 0.5;
constexpr double deepest_mm = 12;  // the exact search looks no farther
/// Nearer than this the way to the nearest point says little about the surface's direction.
constexpr double close_mm = 0.02;

FieldSettings field_settings(const Box& region) {
  return {.spacing_mm = spacing_mm, .band_mm = band_mm, .region = region};
}

Touch make_touch(int index, const NetPoint& point, double distance, const Vector3d& normal,
                 double allowed, double stiffness) {
  Touch touch;
  touch.point = index;
  touch.gap = distance + allowed;
  touch.row.normal = normal;
  touch.row.stiffness = stiffness;
  for (int k = 0; k < point.count; ++k) {
    touch.row.node[k] = point.node[k];
    touch.row.weight[k] = point.weight[k];
  }
  touch.row.count = point.count;
  return touch;
}

}  // namespace

Vector3d NetPoint::at(const Nodes& x) const {
  Vector3d sum = weight[0] * x[node[0]];
  for (int k = 1; k < count; ++k) sum += weight[k] * x[node[k]];
  return sum;
}

NetObstacle::NetObstacle(const TriMesh& mesh, const Box& region, const std::filesystem::path& cache,
                         int threads)
    : field_(cache.empty() ? DistanceField(mesh, field_settings(region), threads)
                           : kept_field(cache, mesh, field_settings(region), threads)),
      surface_(mesh) {}

bool NetObstacle::near(const Vector3d& p, double reach, Near& near) const {
  const FieldSample sample = field_.at(p);
  if (sample.known) {
    const double steep = sample.gradient.norm();
    if (sample.distance_mm > reach) return false;
    if (steep > 0.7) {  // not where two surfaces are equally near
      near = {sample.distance_mm, sample.gradient / steep};
      return true;
    }
  } else if (field_.lower_bound(p) > reach || surface_.empty()) {
    return false;
  }
  const SurfacePoint found = surface_.signed_nearest(p, deepest_mm);
  if (found.triangle < 0 || found.distance > reach) return false;
  near.distance = found.distance;
  near.normal = std::abs(found.distance) > close_mm ? Vector3d((p - found.point) / found.distance)
                                                    : surface_.pseudonormal(found).normalized();
  return true;
}

void touch_obstacle(const std::vector<NetPoint>& points, const std::vector<double>& allowance,
                    const NetObstacle& obstacle, const Pose& X_WO, const Nodes& x,
                    const TouchSettings& settings, std::vector<Touch>& touches) {
  const Pose X_OW = X_WO.inverse();
  NetObstacle::Near near;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!obstacle.near(X_OW * points[i].at(x), settings.reach_mm, near)) continue;
    touches.push_back(make_touch(static_cast<int>(i), points[i], near.distance,
                                 X_WO.R * near.normal, allowance[i], settings.stiffness));
    Touch& touch = touches.back();
    touch.row.offset = touch.row.along(x) - touch.gap;
  }
}

void touch_surface(const std::vector<NetPoint>& points, const std::vector<double>& allowance,
                   const std::vector<std::array<int, 3>>& triangles, const Nodes& x,
                   const TouchSettings& settings, std::vector<Touch>& touches) {
  Box box;
  for (const auto& t : triangles)
    for (int node : t) box.add(x[node]);
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (box.contains(points[i].at(x), settings.reach_mm)) candidates.push_back(i);
  if (candidates.empty()) return;

  TriMesh surface;  // some hundred triangles: a tree of them is made in no time
  surface.vertices.reserve(3 * triangles.size());
  for (const auto& t : triangles) {
    const int first = static_cast<int>(surface.vertices.size());
    for (int node : t) surface.vertices.push_back(x[node]);
    surface.triangles.emplace_back(first, first + 1, first + 2);
  }
  const TriangleTree tree(surface);
  for (std::size_t i : candidates) {
    const Vector3d p = points[i].at(x);
    const SurfacePoint found = tree.signed_nearest(p, settings.reach_mm);
    if (found.triangle < 0) continue;
    const Vector3d normal = std::abs(found.distance) > close_mm
                                ? Vector3d((p - found.point) / found.distance)
                                : Vector3d(tree.pseudonormal(found).normalized());
    touches.push_back(make_touch(static_cast<int>(i), points[i], found.distance, normal,
                                 allowance[i], settings.stiffness));
    Touch& touch = touches.back();
    const auto& other = triangles[static_cast<std::size_t>(found.triangle)];
    for (int k = 0; k < 3; ++k) {
      if (found.barycentric[k] == 0) continue;
      touch.row.node[touch.row.count] = other[k];
      touch.row.weight[touch.row.count++] = -found.barycentric[k];
    }
    touch.row.offset = touch.row.along(x) - touch.gap;
  }
}

void allow(const std::vector<Touch>& touches, std::vector<double>& allowance) {
  for (const auto& touch : touches)
    if (touch.gap < 0) allowance[touch.point] -= touch.gap;
}

double plane_error(const std::vector<Touch>& before, const std::vector<Touch>& now,
                   const Nodes& x) {
  double worst = 0;
  const auto push = [](double gap) { return std::max(0.0, -gap); };
  std::size_t i = 0, j = 0;
  while (i < before.size() || j < now.size()) {
    const bool only_before =
        j == now.size() || (i < before.size() && before[i].point < now[j].point);
    const bool only_now = i == before.size() || (!only_before && now[j].point < before[i].point);
    if (only_before) {
      worst = std::max(worst, push(before[i++].row.gap(x)));
    } else if (only_now) {
      worst = std::max(worst, push(now[j++].gap));
    } else {
      const Vector3d was = push(before[i].row.gap(x)) * before[i].row.normal;
      worst = std::max(worst, (push(now[j].gap) * now[j].row.normal - was).norm());
      ++i;
      ++j;
    }
  }
  return worst;
}

TouchingResult solve_touching(const std::function<Looks(const Nodes&)>& look,
                              const std::function<void()>& solve, NetLoads& loads, Nodes& x,
                              const TouchingSettings& settings) {
  TouchingResult result;
  Looks now = look(x);
  do {
    loads.contacts.clear();
    for (const auto& touches : now)
      for (const auto& touch : touches) loads.contacts.push_back(touch.row);
    solve();
    ++result.solves;
    result.looks = std::move(now);
    now = look(x);
    result.error_mm = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
      result.error_mm = std::max(result.error_mm, plane_error(result.looks[i], now[i], x));
  } while (result.error_mm > settings.tolerance_mm && result.solves < settings.most_looks);
  result.looks = std::move(now);
  return result;
}

}  // namespace condyle
