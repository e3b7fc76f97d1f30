#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/osteotomy/recipe.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A prism along the normal with this many sides around a disc.
constexpr int disc_sides = 16;

Cut cut_of(const PlanePatch& patch) {
  const Vector3d n = patch.normal.normalized();
  Cut cut{"", Region::above(plane_through(patch.point, n)), {}, 0};
  if (const auto* radius = std::get_if<double>(&patch.reach)) {
    const Vector3d u = n.unitOrthogonal(), v = n.cross(u);
    for (int i = 0; i < disc_sides; ++i) {
      const double angle = 2 * 3.14159265358979323846 * i / disc_sides;
      const Vector3d out = std::cos(angle) * u + std::sin(angle) * v;
      cut.reach.push_back(plane_through(patch.point + *radius * out, out));
    }
    // What lies far beside a patch is no side of it.
    for (const double sign : {1., -1.})
      cut.reach.push_back(plane_through(patch.point + sign * *radius * n, sign * n));
    return cut;
  }
  const auto& rectangle = std::get<PatchRectangle>(patch.reach);
  const Vector3d along = (rectangle.axis - rectangle.axis.dot(n) * n).normalized(),
                 across = n.cross(along);
  for (const double sign : {1., -1.}) {
    cut.reach.push_back(
        plane_through(patch.point + sign * rectangle.half_along_mm * along, sign * along));
    cut.reach.push_back(
        plane_through(patch.point + sign * rectangle.half_across_mm * across, sign * across));
    const double depth = std::max(rectangle.half_along_mm, rectangle.half_across_mm);
    cut.reach.push_back(plane_through(patch.point + sign * depth * n, sign * n));
  }
  return cut;
}

/// The side called "above" lies to the left of the polyline, seen against the direction.
Cut cut_of(const BentSheet& sheet) {
  const Vector3d into = sheet.direction.normalized();
  const auto across = [&](std::size_t i) {
    Vector3d step = sheet.polyline[i + 1] - sheet.polyline[i];
    return Vector3d((step - step.dot(into) * into).normalized());
  };
  const Vector3d first = across(0), last = across(sheet.polyline.size() - 2);
  Cut cut{"", beyond_sheet(sheet.polyline, into, first.cross(into)), {}, 0};
  double front = 1e9, back = -1e9;
  for (const auto& p : sheet.polyline) {
    front = std::min(front, into.dot(p));
    back = std::max(back, into.dot(p));
  }
  cut.reach.push_back({into, back + sheet.depth_mm});
  cut.reach.push_back({-into, sheet.overhang_mm - front});
  cut.reach.push_back(plane_through(sheet.polyline.front(), -first));
  cut.reach.push_back(plane_through(sheet.polyline.back(), last));
  return cut;
}

}  // namespace

PlacedOsteotomy place_surfaces(const CutStep& step, const std::string& part) {
  PlacedOsteotomy placed;
  placed.part = part;
  const std::size_t count = step.surfaces.size();
  for (std::size_t i = 0; i < count; ++i) {
    Cut cut = std::visit([](const auto& surface) { return cut_of(surface); }, step.surfaces[i]);
    cut.name = count == 1 ? "cut" : fmt::format("surface {}", i + 1);
    cut.kerf_mm = step.kerf_mm;
    placed.cuts.push_back(std::move(cut));
  }
  auto names = step.pieces;
  if (names.empty() && count == 1) names = {"above", "below"};
  if (names.size() > count + 1)
    throw InputError(fmt::format("{} surfaces make at most {} segments by name; the step names {}",
                                 count, count + 1, names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    SegmentRule rule{names[i], std::vector<CutSide>(count, CutSide::neither)};
    if (i < count) {
      rule.sides[i] = CutSide::above;
    } else {
      rule.sides.assign(count, CutSide::below);
    }
    placed.segments.push_back(std::move(rule));
  }
  return placed;
}

}  // namespace condyle
