#include "engine/tissue/mesh_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double band_mm = 2.0;
/// The error is an eighth of the spacing's square times the curvature: 0.01 mm on a crown.
constexpr double spacing_mm = 0.5;
constexpr double deepest_mm = 12;  // limit of the exact search
/// Search depth below another part of the mesh,
constexpr double deepest_of_surface_mm = 7;
/// and search distance beyond its rim.
constexpr double beside_mm = 6;
/// Beyond the rim the surface is extended with this radius of curvature, and straight below this
/// cosine. With a flat extension a point far beside the rim would react strongly to small rotations
/// of the surface.
constexpr double round_mm = 8;
constexpr double min_cosine = 0.5;
/// Below this distance the direction to the nearest point is not a reliable normal.
constexpr double close_mm = 0.02;

/// Radius over which normals are averaged. Tissue slides without friction and would otherwise come
/// to rest in the small pits of grid cells and triangles, in a position that depends on its path.
constexpr double patch_mm = 0.5;
/// No contact force acts beyond pressing_mm; over the last transition_mm the averaged normal fades
/// into the local one.
constexpr double pressing_mm = 0.5, transition_mm = 0.1;

constexpr double field_error_mm = 0.05;  // largest error, at edges

FieldSettings field_settings(const Box& region) {
  return {.spacing_mm = spacing_mm, .band_mm = band_mm, .region = region};
}

PointContact make_contact(int index, const MeshPoint& point, double distance,
                          const Vector3d& normal, double allowed, double stiffness) {
  PointContact contact;
  contact.point = index;
  contact.gap = distance + allowed;
  contact.spring.normal = normal;
  contact.spring.stiffness = stiffness;
  for (int k = 0; k < point.count; ++k) {
    contact.spring.node[k] = point.node[k];
    contact.spring.weight[k] = point.weight[k];
  }
  contact.spring.count = point.count;
  return contact;
}

}  // namespace

ContactObstacle::ContactObstacle(const TriMesh& mesh, const Box& region,
                                 const std::filesystem::path& cache, int threads)
    : field_(cache.empty() ? DistanceField(mesh, field_settings(region), threads)
                           : cached_field(cache, mesh, field_settings(region), threads)),
      surface_({mesh.vertices, mesh.triangles, {}}) {}

ContactObstacle::ContactObstacle(const TriMesh& piece, const TriMesh& uncut,
                                 const ContactObstacle& of_uncut,
                                 const std::filesystem::path& cache, int threads)
    : field_(cached_piece_field(cache, piece, uncut, of_uncut.field_, threads)),
      surface_({piece.vertices, piece.triangles, {}}) {}

double ContactObstacle::gradient_length(const Vector3d& p) const {
  constexpr double step_mm = 0.5 * spacing_mm;
  Vector3d twice;
  for (int k = 0; k < 3; ++k) {
    const Vector3d step = step_mm * Vector3d::Unit(k);
    const DistanceField::Spot before = field_.spot(p - step), after = field_.spot(p + step);
    if (!before.known || !after.known) return 0;
    twice[k] = after.distance_mm - before.distance_mm;
  }
  return twice.norm() / (2 * step_mm);
}

bool ContactObstacle::near(const Vector3d& p, double reach, Near& near) const {
  // Between equally near surfaces interpolation rounds the edges off: there the exact distance
  // takes over, gradually, so that tissue finds an equilibrium at an edge.
  constexpr double rounded = 0.5, smooth = 0.7;
  const DistanceField::Spot spot = field_.spot(p);
  if (spot.known && spot.distance_mm > reach) {
    near.distance = spot.distance_mm;
    return false;
  }
  near.distance = spot.known ? -deepest_mm : field_.lower_bound(p);
  double of_field = 0;  // fraction
  Near field;
  if (spot.known) {
    const Vector3d gradient = field_.gradient(spot);
    if (!gradient.isZero(0))
      of_field = std::clamp((gradient_length(p) - rounded) / (smooth - rounded), 0.0, 1.0);
    field = {spot.distance_mm, gradient.normalized()};
    if (of_field == 1) {
      near = field;
      apply_patch_normal(p, near);
      return true;
    }
  } else {
    const bool beyond = !spot.corner && spot.distance_mm > 0;  // the band, or the region
    if (beyond || near.distance > reach || surface_.get().empty()) return false;
  }
  const SurfacePoint found = surface_.get().signed_nearest(p, deepest_mm);
  if (found.triangle < 0) return false;
  near.distance = (1 - of_field) * found.distance + of_field * field.distance;
  if (near.distance > reach) return false;
  near.normal = std::abs(found.distance) > close_mm
                    ? Vector3d((p - found.point) / found.distance)
                    : surface_.get().pseudonormal(found).normalized();
  if (of_field > 0)
    near.normal = ((1 - of_field) * near.normal + of_field * field.normal).normalized();
  apply_patch_normal(p, near);
  return true;
}

void ContactObstacle::apply_patch_normal(const Vector3d& p, Near& near) const {
  if (near.distance >= pressing_mm) return;
  const double fraction = std::min(1.0, (pressing_mm - near.distance) / transition_mm);
  near.normal += fraction * (patch_normal(p, near.normal) - near.normal);
  near.normal.normalize();
}

Vector3d ContactObstacle::patch_normal(const Vector3d& p, const Vector3d& own) const {
  constexpr double least = 0.3;  // of the sum for parallel directions
  static const std::array<Vector3d, 4> tetrahedron{
      {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& direction : tetrahedron) {
    const DistanceField::Spot spot = field_.spot(p + patch_mm * direction);
    if (!spot.known) return own;
    sum += spot.distance_mm * direction;
  }
  return sum.norm() > least * 4 * patch_mm ? Vector3d(sum.normalized()) : own;
}

Vector3d ContactObstacle::exit_displacement(const Vector3d& p) const {
  const SurfacePoint found = surface_.get().signed_nearest(p, deepest_mm);
  return found.triangle < 0 || found.distance >= 0 ? Vector3d(Vector3d::Zero())
                                                   : Vector3d(found.point - p);
}

void find_obstacle_contacts(const std::vector<MeshPoint>& points,
                            const std::vector<double>& allowance, const ContactObstacle& obstacle,
                            const Pose& X_WO, const Nodes& x, const PointContactSettings& settings,
                            std::vector<PointContact>& contacts, const Nodes& shift,
                            NearPoints* known) {
  assert(allowance.size() == points.size());
  assert(shift.empty() || shift.size() == points.size());
  const Pose X_OW = X_WO.inverse();
  const Eigen::Matrix3d R_OW = X_OW.R.toRotationMatrix(), R_WO = X_WO.R.toRotationMatrix();
  const auto query = [&](int i) {
    ContactObstacle::Near near;
    const Vector3d at = points[i].at(x);
    Vector3d here = R_OW * at + X_OW.t;
    if (!shift.empty()) here += shift[i];
    if (obstacle.near(here, settings.reach_mm, near)) {
      contacts.push_back(make_contact(i, points[i], near.distance, R_WO * near.normal, allowance[i],
                                      settings.stiffness));
      PointContact& contact = contacts.back();
      contact.spring.offset = contact.spring.along(x) - contact.gap;
      contact.at = at;
    }
    return near.distance - 2 * field_error_mm;  // margin for this and the next query
  };
  if (!known) {
    for (std::size_t i = 0; i < points.size(); ++i) query(static_cast<int>(i));
    return;
  }
  Nodes seen(x.size());  // from the obstacle
  for (std::size_t i = 0; i < x.size(); ++i) seen[i] = R_OW * x[i] + X_OW.t;
  known->moved(points, std::move(seen));
  known->each(settings.reach_mm, query);
}

Vector3d limit_angle(const Vector3d& normal, const Vector3d& front, double least) {
  assert(std::abs(front.norm() - 1) < 1e-6 && std::abs(least) <= 1);
  const double cosine = normal.dot(front);
  if (cosine >= least) return normal;
  const Vector3d across = normal - cosine * front;
  if (across.norm() < 1e-6) return front;
  return least * front + std::sqrt(1 - least * least) * across.normalized();
}

void find_surface_contacts(const std::vector<MeshPoint>& points,
                           const std::vector<double>& allowance, const MeshSurface& surface,
                           const Nodes& x, const PointContactSettings& settings,
                           std::vector<PointContact>& contacts, const Vector3d& facing) {
  assert(allowance.size() == points.size());
  constexpr double min_facing = 0.5;
  const double reach = std::max(settings.reach_mm, deepest_of_surface_mm);
  Box box;
  for (int node : surface.nodes()) box.add(x[node]);
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (box.contains(points[i].at(x), reach)) candidates.push_back(i);
  if (candidates.empty()) return;

  const TriMesh placed = surface.placed(x);
  const TriangleTree tree = surface.tree(placed);
  std::vector<Vector3d> normals;  // at the nodes: means of the adjacent faces
  for (std::size_t i : candidates) {
    const Vector3d p = points[i].at(x);
    const SurfacePoint found = tree.nearest(p, reach);
    if (found.triangle < 0) continue;
    if (normals.empty()) normals = vertex_normals(placed);
    const auto& corners = placed.triangles[found.triangle];
    Vector3d normal = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) normal += found.barycentric[k] * normals[corners[k]];
    normal.normalize();
    if (!facing.isZero()) normal = limit_angle(normal, facing, min_facing);
    double distance = normal.dot(p - found.point);
    const Vector3d beyond = p - found.point - distance * normal;
    const double beside = beyond.norm();
    if (distance > settings.reach_mm || beside > beside_mm) continue;
    if (beside > 0 && surface.on_rim(found.triangle, found.barycentric)) {
      const Vector3d middle = found.point - round_mm * normal;
      const double far = std::hypot(distance + round_mm, beside);
      const double cosine = std::max((distance + round_mm) / far, min_cosine);
      normal = cosine * normal + std::sqrt(1 - cosine * cosine) / beside * beyond;
      distance = normal.dot(p - middle) - round_mm;
      if (distance > settings.reach_mm) continue;
    }
    contacts.push_back(make_contact(static_cast<int>(i), points[i], distance, normal, allowance[i],
                                    settings.stiffness));
    PointContact& contact = contacts.back();
    const auto& other = surface.triangles()[static_cast<std::size_t>(found.triangle)];
    for (int k = 0; k < 3; ++k) {
      if (found.barycentric[k] == 0) continue;
      contact.spring.node[contact.spring.count] = other[k];
      contact.spring.weight[contact.spring.count++] = -found.barycentric[k];
    }
    contact.spring.offset = contact.spring.along(x) - contact.gap;
    contact.at = p;
  }
}

void allow_depths(const std::vector<PointContact>& contacts, std::vector<double>& allowance) {
  for (const auto& contact : contacts)
    if (contact.gap < 0) allowance[contact.point] -= contact.gap;
}

double plane_error(const std::vector<PointContact>& used, const std::vector<PointContact>& now,
                   const Nodes& x) {
  double worst = 0;
  std::size_t i = 0;
  for (const auto& contact : now) {
    for (; i < used.size() && used[i].point < contact.point; ++i)
      worst = std::max(worst, used[i].pressed(x));
    double least = std::max(0.0, -contact.gap);  // for a point without a plane
    for (bool first = true; i < used.size() && used[i].point == contact.point; ++i, first = false) {
      const Vector3d was = used[i].pressed(x) * used[i].spring.normal;
      const Vector3d is = std::max(0.0, used[i].push - contact.gap) * contact.spring.normal;
      const double error = (is - was).norm();
      least = first ? error : std::min(least, error);
    }
    worst = std::max(worst, least);
  }
  for (; i < used.size(); ++i) worst = std::max(worst, used[i].pressed(x));
  return worst;
}

namespace {

/// Rotates the plane of a contact by a fraction towards `normal`; its gap at x is the contact's
/// over the steepness.
void lean(const Vector3d& normal, double fraction, PointContact& contact, const Nodes& x) {
  contact.spring.normal = ((1 - fraction) * contact.spring.normal + fraction * normal).normalized();
  contact.spring.offset = contact.spring.along(x) - contact.gap / contact.steepness;
}

/// Rate of the gap over that of the plane, from the last search to this one.
double steepness(const PointContact& used, const PointContact& now, const Nodes& x) {
  constexpr double least_mm = 1e-6, most = 16;
  const double of_plane = used.spring.gap(x) - used.gap / used.steepness;
  if (std::abs(of_plane) < least_mm) return used.steepness;
  return std::clamp((now.gap - used.gap) / of_plane, 1.0, most);
}

}  // namespace

std::vector<PointContact> with_history(const std::vector<PointContact>& used,
                                       std::vector<PointContact> now, const Nodes& x,
                                       double fraction, bool relaxed, bool steepened) {
  const double same_face = relaxed ? 0.7 : 0.9;  // cosine between the planes
  constexpr double stale_mm = 0.1;  // a plane is discarded when its point has moved this far
  std::vector<PointContact> both;
  std::size_t i = 0;
  for (auto& contact : now) {
    while (i < used.size() && used[i].point < contact.point) ++i;
    const std::size_t at = both.size();
    both.push_back(std::move(contact));
    for (; i < used.size() && used[i].point == both[at].point; ++i) {
      const double cosine = used[i].spring.normal.dot(both[at].spring.normal);
      if (cosine >= same_face) {
        const double force = cosine * used[i].spring.stiffness * used[i].pressed(x);
        both[at].push = std::max(both[at].push, force / both[at].spring.stiffness);
        const bool overshot = used[i].gap * both[at].gap < 0;
        if (steepened) both[at].steepness = used[i].steepness;
        if ((relaxed || (steepened && overshot)) && fraction > 0)
          both[at].steepness = steepness(used[i], both[at], x);
        if (fraction > 0) lean(used[i].spring.normal, fraction, both[at], x);
      } else if ((used[i].at - both[at].at).norm() < stale_mm &&
                 used[i].spring.gap(x) - cosine * both[at].gap > 0) {  // a groove, not an edge
        both.push_back(used[i]);
        both.back().push = used[i].pressed(x);
      }
    }
  }
  return both;
}

void move_contacts(const Pose& X, std::vector<PointContact>& contacts) {
  for (auto& contact : contacts) {
    contact.spring.normal = X.R * contact.spring.normal;
    contact.spring.offset += contact.spring.normal.dot(X.t);
    contact.at = X * contact.at;
  }
}

void set_contacts(const ContactLists& lists, MeshLoads& loads) {
  loads.contacts.clear();
  for (const auto& contacts : lists)
    for (const auto& contact : contacts) {
      loads.contacts.push_back(contact.spring);
      loads.contacts.back().offset += contact.push;
    }
}

namespace {

/// Largest distance of a pressed point from its surface, mm. `contacts`: with history; their
/// multipliers are the forces at x, even where these hold a point too far out.
double gap_left(const std::vector<PointContact>& contacts, const Nodes& x) {
  double most = 0;
  for (const auto& contact : contacts)
    if (contact.push > 0 || contact.pressed(x) > 0)
      most = std::max(most, contact.steepness * std::abs(contact.spring.gap(x)));
  return most;
}

}  // namespace

ContactSolveResult solve_contact(const std::function<ContactLists(const Nodes&)>& query,
                                 const std::function<Solved(bool contacts_settled)>& solve,
                                 MeshLoads& loads, Nodes& x, const ContactSolveSettings& settings,
                                 const ContactLists& before) {
  // Planes that have not converged by then may oscillate: between two directions,
  const int undamped_searches = settings.damped ? 0 : 2;
  // or because the gap changes several times as fast as its plane predicts.
  constexpr int plain_searches = 12;
  ContactSolveResult result;
  ContactLists used = query(x);
  for (std::size_t i = 0; i < before.size(); ++i)
    used[i] = with_history(before[i], used[i], x, 0, settings.relaxed);
  bool contacts_settled = false;
  while (true) {
    set_contacts(used, loads);
    const Solved solved = solve(contacts_settled);
    ++result.solves;
    result.contacts = query(x);
    result.error_mm = result.gap_mm = 0;
    const double fraction = result.solves > undamped_searches ? 0.5 : 0.0;
    const bool steepened = result.solves > plain_searches;
    for (std::size_t i = 0; i < used.size(); ++i) {
      result.error_mm = std::max(result.error_mm, plane_error(used[i], result.contacts[i], x));
      result.contacts[i] = with_history(used[i], std::move(result.contacts[i]), x, fraction,
                                        settings.relaxed, steepened);
      result.gap_mm = std::max(result.gap_mm, gap_left(result.contacts[i], x));
    }
    const auto within = [&](double error_mm, double gap_mm) {
      return result.error_mm <= error_mm && result.gap_mm <= gap_mm;
    };
    contacts_settled = within(settings.tolerance_mm, settings.gap_mm);
    result.settled = solved == Solved::at_minimum && contacts_settled;
    const bool as_good_as_may_be =
        solved == Solved::budget_spent && within(settings.rough_mm, settings.rough_mm);
    if (result.settled || as_good_as_may_be || result.solves >= settings.max_contact_searches)
      return result;
    used = result.contacts;
  }
}

}  // namespace condyle
