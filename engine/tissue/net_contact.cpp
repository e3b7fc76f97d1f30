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

double plane_error(const std::vector<Touch>& used, const std::vector<Touch>& now, const Nodes& x) {
  const auto push = [](double gap) { return std::max(0.0, -gap); };
  double worst = 0;
  std::size_t i = 0;
  for (const auto& touch : now) {
    for (; i < used.size() && used[i].point < touch.point; ++i)
      worst = std::max(worst, push(used[i].row.gap(x)));
    double least = push(touch.gap);  // where no plane stood
    for (bool first = true; i < used.size() && used[i].point == touch.point; ++i, first = false) {
      const Vector3d was = push(used[i].row.gap(x)) * used[i].row.normal;
      const double error = (push(touch.gap) * touch.row.normal - was).norm();
      least = first ? error : std::min(least, error);
    }
    worst = std::max(worst, least);
  }
  for (; i < used.size(); ++i) worst = std::max(worst, push(used[i].row.gap(x)));
  return worst;
}

std::vector<Touch> with_other_faces(const std::vector<Touch>& used, std::vector<Touch> now,
                                    const Nodes& x) {
  constexpr double same_face = 0.9;  // cosine between the planes
  std::vector<Touch> both;
  std::size_t i = 0;
  for (auto& touch : now) {
    while (i < used.size() && used[i].point < touch.point) ++i;
    both.push_back(std::move(touch));
    const Vector3d normal = both.back().row.normal;
    for (; i < used.size() && used[i].point == both.back().point; ++i)
      if (used[i].row.normal.dot(normal) < same_face && used[i].row.gap(x) < 0.5)
        both.push_back(used[i]);
  }
  return both;
}

void set_contacts(const Looks& looks, NetLoads& loads) {
  loads.contacts.clear();
  for (const auto& touches : looks)
    for (const auto& touch : touches) loads.contacts.push_back(touch.row);
}

TouchingResult solve_touching(const std::function<Looks(const Nodes&)>& look,
                              const std::function<void()>& solve, NetLoads& loads, Nodes& x,
                              const TouchingSettings& settings) {
  TouchingResult result;
  Looks used = look(x);
  while (true) {
    set_contacts(used, loads);
    solve();
    ++result.solves;
    result.looks = look(x);
    result.error_mm = 0;
    for (std::size_t i = 0; i < used.size(); ++i)
      result.error_mm = std::max(result.error_mm, plane_error(used[i], result.looks[i], x));
    if (result.error_mm <= settings.tolerance_mm || result.solves >= settings.most_looks)
      return result;
    for (std::size_t i = 0; i < used.size(); ++i)
      used[i] = with_other_faces(used[i], result.looks[i], x);
  }
}

}  // namespace condyle
