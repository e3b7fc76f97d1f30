#include "sim/osteotomy/danger_zones.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/mesh/triangle_tree.h"

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

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

void add_teeth(const Part& part, std::vector<DangerZone>& zones) {
  for (const Tooth& tooth : part.teeth) {
    DangerZone zone{fmt::format("tooth {}", tooth.fdi), DangerZone::Kind::tooth, {}, 0};
    std::vector<int> vertices;
    for (int i = 0; i < tooth.triangle_count; ++i)
      for (const int v : part.mesh.triangles[tooth.first_triangle + i]) vertices.push_back(v);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const int v : vertices) zone.points.push_back(part.mesh.vertices[v]);
    zones.push_back(std::move(zone));
  }
}

}  // namespace

const DangerMargin& DangerMargins::of(DangerZone::Kind kind) const {
  switch (kind) {
    case DangerZone::Kind::canal:
      return canal;
    case DangerZone::Kind::foramen:
      return foramen;
    default:
      return tooth;
  }
}

std::vector<DangerZone> danger_zones(const Case& patient) {
  std::vector<DangerZone> zones;
  for (const Part& part : patient.parts)
    if (is_teeth(part.role)) add_teeth(part, zones);
  for (const Canal& canal : patient.canals)
    zones.push_back({spaced(canal.name), DangerZone::Kind::canal, dense_points(canal.points),
                     0.5 * canal.diameter_mm});
  for (const char* side : {"left", "right"})
    for (const char* foramen : {"mental_foramen", "infraorbital_foramen"}) {
      const std::string name = std::string(side) + "_" + foramen;
      if (const auto at = patient.landmarks.find(name))
        zones.push_back({spaced(name), DangerZone::Kind::foramen, {*at}, 0});
    }
  return zones;
}

std::vector<DangerFinding> check_danger_zones(const std::vector<DangerZone>& zones,
                                              const std::vector<Piece>& pieces,
                                              const DangerMargins& margins, double reach_mm) {
  TriMesh walls;
  for (const Piece& piece : pieces)
    for (std::size_t i = 0; i < piece.wall.size(); ++i) {
      if (piece.wall[i] < 0) continue;
      const int first = static_cast<int>(walls.vertices.size());
      for (const int v : piece.mesh.triangles[i]) walls.vertices.push_back(piece.mesh.vertices[v]);
      walls.triangles.push_back({first, first + 1, first + 2});
    }
  const TriangleTree tree(walls);
  std::vector<DangerFinding> findings;
  if (tree.empty()) return findings;
  for (const DangerZone& zone : zones) {
    SurfacePoint nearest;
    nearest.distance = reach_mm + zone.radius_mm;
    for (const auto& p : zone.points) {
      const SurfacePoint found = tree.nearest(p, nearest.distance);
      if (found.triangle >= 0 && found.distance < nearest.distance) nearest = found;
    }
    if (nearest.triangle < 0) continue;
    const double distance = nearest.distance - zone.radius_mm;
    const DangerMargin& margin = margins.of(zone.kind);
    findings.push_back({zone.name, zone.kind, distance, nearest.point,
                        distance < margin.stop_mm   ? DangerLevel::stop
                        : distance < margin.warn_mm ? DangerLevel::warn
                                                    : DangerLevel::clear});
  }
  std::stable_sort(
      findings.begin(), findings.end(),
      [](const DangerFinding& a, const DangerFinding& b) { return a.distance_mm < b.distance_mm; });
  return findings;
}

std::string danger_text(const DangerFinding& finding, const DangerMargins& margins) {
  const DangerMargin& margin = margins.of(finding.kind);
  const std::string distance =
      finding.distance_mm < 0 ? fmt::format("the cut enters it by {:.1f} mm", -finding.distance_mm)
                              : fmt::format("{:.1f} mm from the cut", finding.distance_mm);
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
