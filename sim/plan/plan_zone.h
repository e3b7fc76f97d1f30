#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace condyle {

/// What a danger zone is; it decides the default margins.
enum class ZoneKind { tooth, canal, foramen, other };

/// "tooth", "canal", "foramen", "other".
std::string zone_kind_name(ZoneKind kind);
std::optional<ZoneKind> zone_kind_named(const std::string& name);

constexpr double max_zone_radius_mm = 50, max_zone_margin_mm = 50;
constexpr std::size_t max_zone_points = 20000, max_zone_triangles = 20000;

/// A structure of the user's own that cuts should keep away from: a surface, or a polyline with a
/// radius. Cranium's frame at rest, mm.
struct PlanZone {
  std::string name = {};
  ZoneKind kind = ZoneKind::other;
  double radius_mm = 0;                          // around the points or the surface
  std::optional<double> warn_mm = std::nullopt;  // margins; not given: those of the kind
  std::optional<double> stop_mm = std::nullopt;
  std::vector<Eigen::Vector3d> points = {};
  std::vector<Eigen::Vector3i> triangles = {};  // empty: the points are a polyline

  bool operator==(const PlanZone&) const = default;
};

/// A value of a zone that is refused: the item's name within it, and the problem.
struct ZoneProblem {
  std::string item, problem;
};
std::optional<ZoneProblem> problem_of(const PlanZone& zone);

}  // namespace condyle
