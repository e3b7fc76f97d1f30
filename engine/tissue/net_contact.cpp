#include "engine/tissue/net_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double band_mm = 2.0;
/// The error is an eighth of the spacing's square times the curvature: 0.01 mm on a crown.
constexpr double spacing_mm = 0.5;
constexpr double deepest_mm = 12;  // the exact search looks no farther
/// A point of the net is sought this deep below another part of it,
constexpr double deepest_of_surface_mm = 7;
/// and this far beyond its rim.
constexpr double beside_mm = 6;
/// There the surface goes on, bent away with this radius, and straight from this cosine on. Were it
/// level, a point far beside the rim would be thrown about by the least turn of the surface.
constexpr double round_mm = 8;
constexpr double least_cosine = 0.5;
/// Nearer than this the way to the nearest point says little about the surface's direction.
constexpr double close_mm = 0.02;

/// What presses is no point: it feels the mean of the body's directions this far around it. Tissue
/// slides without friction, so it would come to rest in the pits that cells and triangles make, and
/// where it came from would decide in which of them.
constexpr double patch_mm = 0.5;
/// Farther out nothing presses; over the last of it the own direction takes over.
constexpr double pressing_mm = 0.5, going_over_mm = 0.1;

constexpr double field_error_mm = 0.05;  // at most, at edges

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

NetObstacle::NetObstacle(const TriMesh& mesh, const Box& region, const std::filesystem::path& cache,
                         int threads)
    : field_(cache.empty() ? DistanceField(mesh, field_settings(region), threads)
                           : kept_field(cache, mesh, field_settings(region), threads)),
      surface_(mesh) {}

bool NetObstacle::near(const Vector3d& p, double reach, Near& near) const {
  const DistanceField::Spot spot = field_.spot(p);
  if (spot.known && spot.distance_mm > reach) {
    near.distance = spot.distance_mm;
    return false;
  }
  near.distance = spot.known ? -deepest_mm : field_.lower_bound(p);
  if (spot.known) {
    const Vector3d gradient = field_.gradient(spot);
    const double steep = gradient.norm();
    if (steep > 0.7) {  // not where two surfaces are equally near
      near = {spot.distance_mm, gradient / steep};
      feel_patch(p, near);
      return true;
    }
  } else {
    const bool beyond = !spot.corner && spot.distance_mm > 0;  // the band, or the region
    if (beyond || near.distance > reach || surface_.empty()) return false;
  }
  const SurfacePoint found = surface_.signed_nearest(p, deepest_mm);
  if (found.triangle < 0) return false;
  near.distance = found.distance;
  if (near.distance > reach) return false;
  near.normal = std::abs(found.distance) > close_mm ? Vector3d((p - found.point) / found.distance)
                                                    : surface_.pseudonormal(found).normalized();
  feel_patch(p, near);
  return true;
}

void NetObstacle::feel_patch(const Vector3d& p, Near& near) const {
  if (near.distance >= pressing_mm) return;
  const double share = std::min(1.0, (pressing_mm - near.distance) / going_over_mm);
  near.normal += share * (patch_normal(p, near.normal) - near.normal);
  near.normal.normalize();
}

Vector3d NetObstacle::patch_normal(const Vector3d& p, const Vector3d& own) const {
  constexpr double least = 0.3;  // of the sum where all around point one way
  static const std::array<Vector3d, 4> tetrahedron{
      {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& way : tetrahedron) {
    const DistanceField::Spot spot = field_.spot(p + patch_mm * way);
    if (!spot.known) return own;
    sum += spot.distance_mm * way;
  }
  return sum.norm() > least * 4 * patch_mm ? Vector3d(sum.normalized()) : own;
}

Vector3d NetObstacle::way_out(const Vector3d& p) const {
  const SurfacePoint found = surface_.signed_nearest(p, deepest_mm);
  return found.triangle < 0 || found.distance >= 0 ? Vector3d(Vector3d::Zero())
                                                   : Vector3d(found.point - p);
}

void touch_obstacle(const std::vector<NetPoint>& points, const std::vector<double>& allowance,
                    const NetObstacle& obstacle, const Pose& X_WO, const Nodes& x,
                    const TouchSettings& settings, std::vector<Touch>& touches, const Nodes& shift,
                    NearPoints* known) {
  const Pose X_OW = X_WO.inverse();
  const Eigen::Matrix3d R_OW = X_OW.R.toRotationMatrix(), R_WO = X_WO.R.toRotationMatrix();
  const auto look = [&](int i) {
    NetObstacle::Near near;
    const Vector3d at = points[i].at(x);
    Vector3d here = R_OW * at + X_OW.t;
    if (!shift.empty()) here += shift[i];
    if (obstacle.near(here, settings.reach_mm, near)) {
      touches.push_back(make_touch(i, points[i], near.distance, R_WO * near.normal, allowance[i],
                                   settings.stiffness));
      Touch& touch = touches.back();
      touch.row.offset = touch.row.along(x) - touch.gap;
      touch.at = at;
    }
    return near.distance - 2 * field_error_mm;  // here, and where it is looked at again
  };
  if (!known) {
    for (std::size_t i = 0; i < points.size(); ++i) look(static_cast<int>(i));
    return;
  }
  Nodes seen(x.size());  // from the obstacle
  for (std::size_t i = 0; i < x.size(); ++i) seen[i] = R_OW * x[i] + X_OW.t;
  known->moved(points, std::move(seen));
  known->each(settings.reach_mm, look);
}

Vector3d led(const Vector3d& normal, const Vector3d& front, double least) {
  const double cosine = normal.dot(front);
  if (cosine >= least) return normal;
  const Vector3d across = normal - cosine * front;
  if (across.norm() < 1e-6) return front;
  return least * front + std::sqrt(1 - least * least) * across.normalized();
}

void touch_surface(const std::vector<NetPoint>& points, const std::vector<double>& allowance,
                   const NetSurface& surface, const Nodes& x, const TouchSettings& settings,
                   std::vector<Touch>& touches, const Vector3d& facing) {
  constexpr double least_facing = 0.5;
  const double reach = std::max(settings.reach_mm, deepest_of_surface_mm);
  Box box;
  for (int node : surface.nodes()) box.add(x[node]);
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (box.contains(points[i].at(x), reach)) candidates.push_back(i);
  if (candidates.empty()) return;

  const TriMesh placed = surface.placed(x);
  const TriangleTree tree = surface.tree(placed);
  std::vector<Vector3d> normals;  // at its nodes: the means of the faces around
  for (std::size_t i : candidates) {
    const Vector3d p = points[i].at(x);
    const SurfacePoint found = tree.nearest(p, reach);
    if (found.triangle < 0) continue;
    if (normals.empty()) normals = vertex_normals(placed);
    const auto& corners = placed.triangles[found.triangle];
    Vector3d normal = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) normal += found.barycentric[k] * normals[corners[k]];
    normal.normalize();
    if (!facing.isZero()) normal = led(normal, facing, least_facing);
    double distance = normal.dot(p - found.point);
    const Vector3d beyond = p - found.point - distance * normal;
    const double beside = beyond.norm();
    if (distance > settings.reach_mm || beside > beside_mm) continue;
    if (beside > 0 && surface.on_rim(found.triangle, found.barycentric)) {
      const Vector3d middle = found.point - round_mm * normal;
      const double far = std::hypot(distance + round_mm, beside);
      const double cosine = std::max((distance + round_mm) / far, least_cosine);
      normal = cosine * normal + std::sqrt(1 - cosine * cosine) / beside * beyond;
      distance = normal.dot(p - middle) - round_mm;
      if (distance > settings.reach_mm) continue;
    }
    touches.push_back(make_touch(static_cast<int>(i), points[i], distance, normal, allowance[i],
                                 settings.stiffness));
    Touch& touch = touches.back();
    const auto& other = surface.triangles()[static_cast<std::size_t>(found.triangle)];
    for (int k = 0; k < 3; ++k) {
      if (found.barycentric[k] == 0) continue;
      touch.row.node[touch.row.count] = other[k];
      touch.row.weight[touch.row.count++] = -found.barycentric[k];
    }
    touch.row.offset = touch.row.along(x) - touch.gap;
    touch.at = p;
  }
}

void allow(const std::vector<Touch>& touches, std::vector<double>& allowance) {
  for (const auto& touch : touches)
    if (touch.gap < 0) allowance[touch.point] -= touch.gap;
}

double plane_error(const std::vector<Touch>& used, const std::vector<Touch>& now, const Nodes& x) {
  double worst = 0;
  std::size_t i = 0;
  for (const auto& touch : now) {
    for (; i < used.size() && used[i].point < touch.point; ++i)
      worst = std::max(worst, used[i].pressed(x));
    double least = std::max(0.0, -touch.gap);  // where no plane stood
    for (bool first = true; i < used.size() && used[i].point == touch.point; ++i, first = false) {
      const Vector3d was = used[i].pressed(x) * used[i].row.normal;
      const Vector3d is = std::max(0.0, used[i].push - touch.gap) * touch.row.normal;
      const double error = (is - was).norm();
      least = first ? error : std::min(least, error);
    }
    worst = std::max(worst, least);
  }
  for (; i < used.size(); ++i) worst = std::max(worst, used[i].pressed(x));
  return worst;
}

namespace {

/// Turns a touch's plane by a share toward `normal`, about the point's gap at x.
void lean(const Vector3d& normal, double share, Touch& touch, const Nodes& x) {
  touch.row.normal = ((1 - share) * touch.row.normal + share * normal).normalized();
  touch.row.offset = touch.row.along(x) - touch.gap;
}

}  // namespace

std::vector<Touch> carried_on(const std::vector<Touch>& used, std::vector<Touch> now,
                              const Nodes& x, double share) {
  constexpr double same_face = 0.9;  // cosine between the planes
  constexpr double stale_mm = 0.1;   // a plane serves no longer when its point has gone this far
  std::vector<Touch> both;
  std::size_t i = 0;
  for (auto& touch : now) {
    while (i < used.size() && used[i].point < touch.point) ++i;
    const std::size_t at = both.size();
    both.push_back(std::move(touch));
    for (; i < used.size() && used[i].point == both[at].point; ++i) {
      const double cosine = used[i].row.normal.dot(both[at].row.normal);
      if (cosine >= same_face) {
        const double force = cosine * used[i].row.stiffness * used[i].pressed(x);
        both[at].push = std::max(both[at].push, force / both[at].row.stiffness);
        if (share > 0) lean(used[i].row.normal, share, both[at], x);
      } else if ((used[i].at - both[at].at).norm() < stale_mm &&
                 used[i].row.gap(x) - cosine * both[at].gap > 0) {  // a groove, not an edge
        both.push_back(used[i]);
        both.back().push = used[i].pressed(x);
      }
    }
  }
  return both;
}

void move_touches(const Pose& X, std::vector<Touch>& touches) {
  for (auto& touch : touches) {
    touch.row.normal = X.R * touch.row.normal;
    touch.row.offset += touch.row.normal.dot(X.t);
    touch.at = X * touch.at;
  }
}

void set_contacts(const Looks& looks, NetLoads& loads) {
  loads.contacts.clear();
  for (const auto& touches : looks)
    for (const auto& touch : touches) {
      loads.contacts.push_back(touch.row);
      loads.contacts.back().offset += touch.push;
    }
}

namespace {

/// How far anything that presses is from the surface it presses on, mm. `touches` have been carried
/// on: their push is what pressed at x, also where that holds a point too far out.
double gap_left(const std::vector<Touch>& touches, const Nodes& x) {
  double most = 0;
  for (const auto& touch : touches)
    if (touch.push > 0 || touch.pressed(x) > 0) most = std::max(most, std::abs(touch.row.gap(x)));
  return most;
}

}  // namespace

TouchingResult solve_touching(const std::function<Looks(const Nodes&)>& look,
                              const std::function<Solved()>& solve, NetLoads& loads, Nodes& x,
                              const TouchingSettings& settings, const Looks& before) {
  // Planes that have not settled by then may go to and fro between two directions.
  constexpr int undamped_looks = 2;
  TouchingResult result;
  Looks used = look(x);
  for (std::size_t i = 0; i < before.size(); ++i) used[i] = carried_on(before[i], used[i], x);
  while (true) {
    set_contacts(used, loads);
    const Solved solved = solve();
    ++result.solves;
    result.looks = look(x);
    result.error_mm = result.gap_mm = 0;
    const double share = result.solves > undamped_looks ? 0.5 : 0.0;
    for (std::size_t i = 0; i < used.size(); ++i) {
      result.error_mm = std::max(result.error_mm, plane_error(used[i], result.looks[i], x));
      result.looks[i] = carried_on(used[i], std::move(result.looks[i]), x, share);
      result.gap_mm = std::max(result.gap_mm, gap_left(result.looks[i], x));
    }
    const auto within = [&](double error_mm, double gap_mm) {
      return result.error_mm <= error_mm && result.gap_mm <= gap_mm;
    };
    result.settled = solved == Solved::at_minimum && within(settings.tolerance_mm, settings.gap_mm);
    const bool as_good_as_may_be =
        solved == Solved::spent && within(settings.rough_mm, settings.rough_mm);
    if (result.settled || as_good_as_may_be || result.solves >= settings.most_looks) return result;
    used = result.looks;
  }
}

}  // namespace condyle
