#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/osteotomy/recipe.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Place of a lower tooth along the arch, from 48 (0) to 38 (15); -1: no lower tooth.
int arch_place(double fdi) {
  const int number = static_cast<int>(fdi), quadrant = number / 10, tooth = number % 10;
  if (number != fdi || tooth < 1 || tooth > 8 || (quadrant != 3 && quadrant != 4)) return -1;
  return quadrant == 4 ? 8 - tooth : 7 + tooth;
}

int fdi_at(int place) { return place < 8 ? 48 - place : 23 + place; }

int place_of(const Site& site, const char* parameter) {
  const int place = arch_place(site[parameter]);
  if (place < 0)
    throw InputError(
        fmt::format("segmental_resection: {} is {:g}; expected the FDI number of a "
                    "lower tooth, 31 to 38 or 41 to 48",
                    parameter, site[parameter]));
  return place;
}

/// The middle of the lower tooth at a place of the arch, where the case has it.
std::optional<Vector3d> middle_of(const SurgicalAnatomy& jaw, int place) {
  if (place < 0 || place > 15) return std::nullopt;
  return jaw.tooth_middle(fdi_at(place));
}

/// The plane between two teeth that keeps the largest distance from both: turned by up to 40
/// degrees about the vertical and tilted by up to 15. Its normal points to the second tooth.
struct Gap {
  Vector3d point, normal;
  double width_mm;  // negative: no plane lies between the teeth
};
Gap gap_between(const std::vector<Vector3d>& tooth, const std::vector<Vector3d>& neighbour,
                const Vector3d& from, const Vector3d& to) {
  Vector3d level = to - from;
  level.z() = 0;
  level.normalize();
  const Vector3d across = level.cross(Vector3d::UnitZ());
  constexpr double degree = 3.14159265358979323846 / 180, oblique_mm_per_deg = 0.01;
  Gap best{{}, {}, -1e9};
  double best_score = -1e9;
  for (int tilt = -15; tilt <= 15; tilt += 3)
    for (int turn = -40; turn <= 40; turn += 4) {
      const Vector3d n = Eigen::AngleAxisd(turn * degree, Vector3d::UnitZ()) *
                         (Eigen::AngleAxisd(tilt * degree, across) * level);
      double end = -1e9, begin = 1e9;
      for (const Vector3d& p : tooth) end = std::max(end, n.dot(p));
      for (const Vector3d& p : neighbour) begin = std::min(begin, n.dot(p));
      const double score = begin - end - oblique_mm_per_deg * (std::abs(turn) + std::abs(tilt));
      if (score <= best_score) continue;
      best_score = score;
      const Vector3d middle = 0.5 * (from + to);
      best = {middle + (0.5 * (begin + end) - n.dot(middle)) * n, n, begin - end};
    }
  return best;
}

/// A cut beside a tooth that is resected, in the gap to its neighbour that stays.
Cut resection_cut(Site& site, int inner, int step, int wall) {
  SurgicalAnatomy& jaw = site.anatomy;
  const auto tooth = middle_of(jaw, inner);
  if (!tooth)
    throw InputError(
        fmt::format("segmental_resection: the case has no tooth {} by itself", fdi_at(inner)));
  Vector3d point, outward;
  if (const auto neighbour = middle_of(jaw, inner + step)) {
    const Gap gap = gap_between(jaw.tooth_points(fdi_at(inner)),
                                jaw.tooth_points(fdi_at(inner + step)), *tooth, *neighbour);
    // Crowns touch: the cut keeps clear of the tooth that stays, and may divide the other.
    constexpr double clear_mm = 0.6;
    outward = gap.normal;
    point =
        gap.point + std::min(0., 0.5 * gap.width_mm - clear_mm - 0.5 * site.kerf_mm) * gap.normal;
  } else if (const auto before = middle_of(jaw, inner - step)) {
    outward = *tooth - *before;
    outward.z() = 0;
    constexpr double half_tooth_mm = 7;
    point = *tooth + half_tooth_mm * outward.normalized();
    jaw.notes.push_back(
        fmt::format("no tooth stands behind {}: the cut lies {:g} mm from its "
                    "middle",
                    fdi_at(inner), half_tooth_mm));
  } else {
    throw InputError(
        fmt::format("segmental_resection: tooth {} has no neighbour from which the "
                    "direction of the jaw follows",
                    fdi_at(inner)));
  }
  outward.normalize();
  point += site["margin_mm"] * outward;
  const Vector3d across = outward.cross(Vector3d::UnitZ()).normalized();
  constexpr double half_depth_mm = 15, half_width_mm = 22;
  Cut cut{
      fmt::format("resection beside {}", fdi_at(inner)), jaw.above(point, -outward, wall), {}, 0};
  for (const double sign : {1., -1.}) {
    cut.reach.push_back(jaw.plane(point + sign * half_depth_mm * outward, sign * outward));
    cut.reach.push_back(jaw.plane(point + sign * half_width_mm * across, sign * across));
  }
  return cut;
}

PlacedOsteotomy place_resection(Site& site) {
  int from = place_of(site, "from_tooth"), to = place_of(site, "to_tooth");
  if (from > to) std::swap(from, to);
  PlacedOsteotomy placed;
  placed.cuts = {resection_cut(site, from, -1, 0), resection_cut(site, to, 1, 1)};
  for (int place = from; place <= to; ++place) placed.removed_teeth.push_back(fdi_at(place));
  placed.segments = {{"resected", {CutSide::above, CutSide::above}}};
  return placed;
}

}  // namespace

Recipe segmental_resection_recipe() {
  return {"segmental_resection",
          Jaw::lower,
          {{"from_tooth", "", "FDI number of the first tooth that is resected", 34, 31, 48},
           {"to_tooth", "", "FDI number of the last tooth that is resected", 37, 31, 48},
           {"margin_mm", "mm", "distance of the cuts beyond the middle of the gaps", 0, -3, 10}},
          place_resection};
}

}  // namespace condyle
