#include "sim/osteotomy/danger_zones.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/osteotomy/interdental.h"

namespace condyle {
namespace {

constexpr double step_mm = 0.5;

/// Points of a polyline at most step_mm apart.
std::vector<Eigen::Vector3d> dense_points(const std::vector<Eigen::Vector3d>& polyline) {
  std::vector<Eigen::Vector3d> points{polyline.front()};
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    const Eigen::Vector3d &from = polyline[i - 1], step = polyline[i] - from;
    const int count = std::max(1, static_cast<int>(std::ceil(step.norm() / step_mm)));
    for (int k = 1; k <= count; ++k) points.push_back(from + k * step / count);
  }
  return points;
}

/// Points of a surface at most about step_mm apart.
std::vector<Eigen::Vector3d> dense_points(const PlanZone& zone) {
  std::vector<Eigen::Vector3d> points = zone.points;
  for (const Eigen::Vector3i& t : zone.triangles) {
    const Eigen::Vector3d &a = zone.points[t[0]], u = zone.points[t[1]] - a,
                          v = zone.points[t[2]] - a;
    const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
    const int count = std::clamp(static_cast<int>(std::ceil(longest / step_mm)), 1, 200);
    for (int i = 0; i <= count; ++i)
      for (int k = 0; k <= count - i; ++k) points.emplace_back(a + (i * u + k * v) / count);
  }
  return points;
}

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

void add_teeth(const Part& part, const DangerMargins& margins, std::vector<DangerZone>& zones) {
  for (const Tooth& tooth : part.teeth) {
    DangerZone zone{.name = fmt::format("tooth {}", tooth.fdi),
                    .kind = ZoneKind::tooth,
                    .points = {},
                    .margin = margins.tooth};
    std::vector<int> vertices;
    for (int i = 0; i < tooth.triangle_count; ++i)
      for (const int v : part.mesh.triangles[tooth.first_triangle + i]) vertices.push_back(v);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const int v : vertices) zone.points.push_back(part.mesh.vertices[v]);
    zones.push_back(std::move(zone));
  }
}

/// The body from which the cuts of a plan made this one.
BodyId uncut_body(const BodyTree& bodies, BodyId body) {
  while (body != cranium_body && bodies[body].driver == BodyDriver::plan)
    body = bodies[body].parent;
  return body;
}

/// Whether no other piece of the bone's jaw lies nearer to the point.
bool is_nearest(const Case& patient, const Part& bone, const Eigen::Vector3d& point) {
  const BodyId jaw = uncut_body(patient.bodies, bone.body);
  std::vector<const Part*> others;
  for (const Part& part : patient.parts)
    if (collides(part.role) && !is_teeth(part.role) && part.body != bone.body &&
        uncut_body(patient.bodies, part.body) == jaw)
      others.push_back(&part);
  if (others.empty()) return true;
  const double own = TriangleTree(bone.mesh).nearest(point).distance;
  return std::none_of(others.begin(), others.end(), [&](const Part* part) {
    const SurfacePoint found = TriangleTree(part->mesh).nearest(point, own);
    return found.triangle >= 0 && found.distance < own;
  });
}

/// Faces that cuts made, as a surface without common vertices.
struct CutFaces {
  TriMesh mesh;
  void add(const Piece& piece, std::size_t face) {
    const int first = static_cast<int>(mesh.vertices.size());
    for (const int v : piece.mesh.triangles[face]) mesh.vertices.push_back(piece.mesh.vertices[v]);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
};

DangerLevel level_of(double distance, const DangerMargin& margin) {
  return distance < margin.stop_mm   ? DangerLevel::stop
         : distance < margin.warn_mm ? DangerLevel::warn
                                     : DangerLevel::clear;
}

/// The deepest point of cut faces in a closed zone; its distance is negative.
SurfacePoint deepest_inside(const DangerZone& zone, const TriMesh& faces) {
  SurfacePoint deepest;
  deepest.distance = 0;
  if (zone.solid.empty()) return deepest;
  const TriangleTree tree(zone.solid);
  Box box;
  for (const auto& p : zone.solid.vertices) box.add(p);
  const auto look = [&](const Eigen::Vector3d& p) {
    if (!box.contains(p, 0)) return;
    const SurfacePoint found = tree.signed_nearest(p);
    if (found.distance < deepest.distance)
      deepest = {found.distance, p, Eigen::Vector3d::Zero(), 0};
  };
  constexpr double grid_mm = 0.7;
  constexpr int most = 80;
  for (const auto& t : faces.triangles) {
    const auto &a = faces.vertices[t[0]], &b = faces.vertices[t[1]], &c = faces.vertices[t[2]];
    Box of_face;
    for (const auto* p : {&a, &b, &c}) of_face.add(*p);
    if ((of_face.low.array() > box.high.array()).any() ||
        (of_face.high.array() < box.low.array()).any())
      continue;
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(longest / grid_mm)), 1, most);
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) look(a + (b - a) * i / n + (c - a) * j / n);
  }
  return deepest;
}

/// Distance of a zone from cut faces; triangle -1: not within reach.
SurfacePoint distance_of(const DangerZone& zone, const std::vector<Eigen::Vector3d>& points,
                         const TriMesh& faces, const TriangleTree& tree, double reach_mm) {
  SurfacePoint nearest;
  nearest.distance = reach_mm + zone.radius_mm;
  for (const auto& p : points) {
    const SurfacePoint found = tree.nearest(p, nearest.distance);
    if (found.triangle >= 0 && found.distance < nearest.distance) nearest = found;
  }
  if (const SurfacePoint inside = deepest_inside(zone, faces); inside.distance < 0)
    nearest = inside;
  nearest.distance -= zone.radius_mm;
  return nearest;
}

}  // namespace

const DangerMargin& DangerMargins::of(ZoneKind kind) const {
  switch (kind) {
    case ZoneKind::canal:
      return canal;
    case ZoneKind::foramen:
      return foramen;
    case ZoneKind::other:
      return other;
    default:
      return tooth;
  }
}

std::vector<DangerZone> danger_zones(const Case& patient, const Part& bone, bool roots,
                                     const DangerMargins& margins) {
  std::vector<DangerZone> zones;
  for (const Part& part : patient.parts)
    if (is_teeth(part.role) && part.body == bone.body) add_teeth(part, margins, zones);
  if (roots && !zones.empty()) {
    const TriangleTree tree(bone.mesh);
    for (DangerZone& zone : zones) {
      NeighbourTooth tooth = split_tooth(zone.points, tree);
      zone.root = tooth.root.empty() ? std::move(tooth.crown) : std::move(tooth.root);
    }
  }
  for (const Canal& canal : patient.canals)
    if (canal.body == bone.body)
      zones.push_back({.name = spaced(canal.name),
                       .kind = ZoneKind::canal,
                       .points = dense_points(canal.points),
                       .radius_mm = 0.5 * canal.diameter_mm,
                       .margin = margins.canal});
  const bool lower = uncut_body(patient.bodies, bone.body) == mandible_body;
  for (const char* side : {"left", "right"}) {
    const std::string name =
        std::string(side) + (lower ? "_mental_foramen" : "_infraorbital_foramen");
    if (const auto at = patient.landmarks.find(name); at && is_nearest(patient, bone, *at))
      zones.push_back({.name = spaced(name),
                       .kind = ZoneKind::foramen,
                       .points = {*at},
                       .margin = margins.foramen});
  }
  return zones;
}

DangerZone own_zone(const PlanZone& zone, const DangerMargins& margins) {
  DangerZone made{.name = zone.name,
                  .kind = zone.kind,
                  .points = zone.triangles.empty() ? dense_points(zone.points) : dense_points(zone),
                  .radius_mm = zone.radius_mm,
                  .margin = margins.of(zone.kind)};
  if (zone.stop_mm) made.margin.stop_mm = *zone.stop_mm;
  made.margin.warn_mm = zone.warn_mm.value_or(std::max(made.margin.warn_mm, made.margin.stop_mm));
  if (!zone.stop_mm) made.margin.stop_mm = std::min(made.margin.stop_mm, made.margin.warn_mm);
  TriMesh surface{zone.points, zone.triangles, {}};
  if (!zone.triangles.empty() && inspect(surface).closed()) made.solid = std::move(surface);
  return made;
}

std::vector<DangerFinding> check_danger_zones(const std::vector<DangerZone>& zones,
                                              const std::vector<Piece>& pieces,
                                              const DangerMargins& margins, double reach_mm) {
  CutFaces between, others;  // teeth, and all else
  for (const Piece& piece : pieces)
    for (std::size_t i = 0; i < piece.wall.size(); ++i)
      if (piece.wall[i] >= 0)
        (piece.wall[i] >= interdental_wall && piece.wall[i] != slot_end ? between : others)
            .add(piece, i);
  const TriangleTree between_tree(between.mesh), others_tree(others.mesh);
  std::vector<DangerFinding> findings;
  for (const DangerZone& zone : zones) {
    std::optional<DangerFinding> worst;
    for (const bool is_between : {false, true}) {
      const auto& faces = is_between ? between.mesh : others.mesh;
      const auto& tree = is_between ? between_tree : others_tree;
      if (tree.empty()) continue;
      const bool interdental = is_between && !zone.root.empty();
      const SurfacePoint nearest =
          distance_of(zone, interdental ? zone.root : zone.points, faces, tree, reach_mm);
      if (nearest.triangle < 0) continue;
      const DangerMargin& margin = interdental ? margins.interdental : zone.margin;
      const DangerFinding found{zone.name,
                                zone.kind,
                                nearest.distance,
                                margin,
                                interdental,
                                nearest.point,
                                level_of(nearest.distance, margin)};
      if (!worst || found.level > worst->level ||
          (found.level == worst->level && found.distance_mm < worst->distance_mm))
        worst = found;
    }
    if (worst) findings.push_back(*worst);
  }
  std::stable_sort(
      findings.begin(), findings.end(),
      [](const DangerFinding& a, const DangerFinding& b) { return a.distance_mm < b.distance_mm; });
  return findings;
}

std::string danger_text(const DangerFinding& finding) {
  const DangerMargin& margin = finding.margin;
  const std::string distance =
      finding.distance_mm < 0 ? fmt::format("the cut enters it by {:.1f} mm", -finding.distance_mm)
                              : fmt::format("{:.1f} mm from the cut{}", finding.distance_mm,
                                            finding.interdental ? " between the teeth" : "");
  switch (finding.level) {
    case DangerLevel::stop:
      return margin.stop_mm > 0 ? fmt::format("{}: {}; at least {:g} mm are needed", finding.zone,
                                              distance, margin.stop_mm)
                                : fmt::format("{}: {}", finding.zone, distance);
    case DangerLevel::warn:
      return fmt::format("{}: {}, less than {:g} mm", finding.zone, distance, margin.warn_mm);
    default:
      return fmt::format("{}: {}", finding.zone, distance);
  }
}

}  // namespace condyle
