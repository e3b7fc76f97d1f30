#include "sim/plan/plan_zone.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace condyle {
namespace {

constexpr std::array<std::pair<const char*, ZoneKind>, 4> zone_kinds{
    {{"tooth", ZoneKind::tooth},
     {"canal", ZoneKind::canal},
     {"foramen", ZoneKind::foramen},
     {"other", ZoneKind::other}}};

std::optional<ZoneProblem> margin_problem(const char* item, double value, double most) {
  if (value >= 0 && value <= most) return std::nullopt;
  return ZoneProblem{item, fmt::format("is {:g} mm; expected 0 to {:g}", value, most)};
}

}  // namespace

std::string zone_kind_name(ZoneKind kind) {
  for (const auto& [name, known] : zone_kinds)
    if (known == kind) return name;
  return "other";
}

std::optional<ZoneKind> zone_kind_named(const std::string& name) {
  for (const auto& [known, kind] : zone_kinds)
    if (known == name) return kind;
  return std::nullopt;
}

std::optional<ZoneProblem> problem_of(const PlanZone& zone) {
  const auto printable = [](unsigned char c) { return c >= ' ' && c != 127; };
  if (zone.name.empty() || zone.name.size() > 100 ||
      !std::all_of(zone.name.begin(), zone.name.end(), printable))
    return ZoneProblem{"name", "is \"" + zone.name.substr(0, 40) +
                                   "\"; expected a name of 1 to 100 printable characters"};
  if (auto found = margin_problem("radius_mm", zone.radius_mm, max_zone_radius_mm)) return found;
  if (zone.warn_mm)
    if (auto found = margin_problem("warn_mm", *zone.warn_mm, max_zone_margin_mm)) return found;
  if (zone.stop_mm)
    if (auto found = margin_problem("stop_mm", *zone.stop_mm, max_zone_margin_mm)) return found;
  if (zone.warn_mm && zone.stop_mm && *zone.warn_mm < *zone.stop_mm)
    return ZoneProblem{
        "warn_mm", fmt::format("is {:g} mm, below stop_mm, {:g}", *zone.warn_mm, *zone.stop_mm)};
  if (zone.points.empty() || zone.points.size() > max_zone_points)
    return ZoneProblem{"points", fmt::format("has {} points; expected 1 to {}", zone.points.size(),
                                             max_zone_points)};
  constexpr double most_mm = 1e4;
  for (std::size_t i = 0; i < zone.points.size(); ++i)
    if (!zone.points[i].allFinite() || zone.points[i].cwiseAbs().maxCoeff() > most_mm)
      return ZoneProblem{fmt::format("points[{}]", i),
                         fmt::format("is no position within {:g} mm", most_mm)};
  if (zone.triangles.size() > max_zone_triangles)
    return ZoneProblem{
        "triangles", fmt::format("has {}; at most {}", zone.triangles.size(), max_zone_triangles)};
  const int count = static_cast<int>(zone.points.size());
  for (std::size_t i = 0; i < zone.triangles.size(); ++i)
    if (zone.triangles[i].minCoeff() < 0 || zone.triangles[i].maxCoeff() >= count)
      return ZoneProblem{fmt::format("triangles[{}]", i),
                         fmt::format("names a point that does not exist; there are {}", count)};
  return std::nullopt;
}

}  // namespace condyle
