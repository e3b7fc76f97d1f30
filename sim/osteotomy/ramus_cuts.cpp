#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "sim/osteotomy/danger_zones.h"
#include "sim/osteotomy/interdental.h"
#include "sim/osteotomy/ramus.h"
#include "sim/osteotomy/recipe.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// One half of the jaw behind a place, from a distance beside the midline on.
std::vector<Plane> half_jaw(const SurgicalAnatomy& jaw, Side side, double front,
                            double beside_mm = 8) {
  return {jaw.plane({beside_mm * sign_of(side), 0, 0}, {-sign_of(side), 0, 0}),
          jaw.plane({0, front, 0}, -Vector3d::UnitY())};
}

/// The vertical cut: from the notch down, behind the lingula, to the lower border in front of
/// gonion. Its upper side is behind it.
struct VerticalCut {
  Vector3d top, normal;
};
VerticalCut vertical_cut(const Site& site, const Ramus& ramus, const Vector3d& notch,
                         const Vector3d& gonion) {
  const double behind = ramus.lingula.y() + site["behind_lingula_mm"];
  Vector3d low(0, std::max(gonion.y() - site["before_gonion_mm"], behind), gonion.z());
  Vector3d top(0, std::max(notch.y(), behind), notch.z());
  // Behind the lingula at its height, too.
  const double share = (ramus.lingula.z() - low.z()) / (top.z() - low.z());
  const double lacking = behind - (low.y() + share * (top.y() - low.y()));
  if (lacking > 0) top.y() += lacking, low.y() += lacking;
  Vector3d normal = (top - low).cross(Vector3d::UnitX());
  if (normal.y() < 0) normal = -normal;
  return {top, normal};
}

Cut ramus_cut(Site& site, Side side, bool with_coronoid) {
  SurgicalAnatomy& jaw = site.anatomy;
  const Ramus ramus = find_ramus(jaw, side);
  const VerticalCut cut = vertical_cut(site, ramus, find_notch(jaw, side), find_gonion(jaw, side));
  Region proximal = jaw.above(cut.top, cut.normal, 0);
  if (with_coronoid) {
    const Vector3d level = ramus.lingula + Vector3d(0, 0, site["above_lingula_mm"]);
    proximal = either(jaw.above(level, occlusal_up(jaw), 1), std::move(proximal));
  }
  return {(with_coronoid ? "inverted L, " : "vertical ramus, ") + name_of(side),
          std::move(proximal), half_jaw(jaw, side, ramus.front - 15), 0};
}

PlacedOsteotomy place_ramus_cuts(Site& site, bool with_coronoid) {
  return {.part = {},
          .cuts = {ramus_cut(site, Side::left, with_coronoid),
                   ramus_cut(site, Side::right, with_coronoid)},
          .segments = proximal_and_distal(),
          .notes = {}};
}

std::vector<OsteotomyParameter> vertical_parameters() {
  return {
      {"behind_lingula_mm", "mm", "least distance of the vertical cut behind the lingula", 4, 2,
       12},
      {"before_gonion_mm", "mm", "the vertical cut in front of gonion, at its height", 8, 4, 15}};
}

/// A vertical cut through the body behind a tooth.
Cut body_cut(Site& site, Side side) {
  SurgicalAnatomy& jaw = site.anatomy;
  const int place = static_cast<int>(site["behind_tooth"]);
  const int first = (side == Side::left ? 30 : 40) + place;
  const std::string name = "body, " + name_of(side);
  constexpr double beside_mm = 1;  // in front, the cut leaves the bone near the midline
  if (const auto plane = find_interdental(jaw, first, first + 1)) {
    jaw.rooms.push_back(room_text(*plane, site.kerf_mm));
    const Vector3d point = plane->point + Vector3d(0, site["back_mm"], 0);
    return {name, jaw.above(point, plane->normal, interdental_wall),
            half_jaw(jaw, side, point.y() - 30, beside_mm), 0};
  }
  // Gaps between teeth behind the incisal edges.
  constexpr double gaps[] = {9.5, 16.5, 23.5, 33};
  const double y = jaw.need("lower_incisal_point").y() + gaps[place - 3] + site["back_mm"];
  if (side == Side::left)
    jaw.notes.push_back("the gaps between the teeth are estimated from the incisal edges");
  // Across the body: along its outer surface.
  const auto outer = [&](double at) -> std::optional<Vector3d> {
    const auto range = jaw.section(side, 1, at, 0, 5);
    if (!range) return std::nullopt;
    return side == Side::left ? range->high_at : range->low_at;
  };
  const auto here = outer(y - 5), there = outer(y + 5), at = outer(y);
  if (!here || !there || !at)
    throw InputError("body_osteotomy: the jaw has no bone at the cut, " + name_of(side));
  // At least so oblique that it passes behind the symphysis.
  double symphysis = at->y();
  for (const Vector3d& p : jaw.bone().vertices)
    if (std::abs(p.x()) < 3) symphysis = std::max(symphysis, p.y() + 1);
  const double wider = (std::abs(there->x()) - std::abs(here->x())) / 10,
               needed = (symphysis - at->y()) / std::abs(at->x());
  const Vector3d along(sign_of(side) * std::clamp(std::max(wider, needed), 0., 2.), 1, 0);
  return {name, jaw.above(*at, along, interdental_wall), half_jaw(jaw, side, y - 30, beside_mm), 0};
}

PlacedOsteotomy place_body(Site& site) {
  const double place = site["behind_tooth"];
  if (place != std::floor(place))
    throw InputError("body_osteotomy: behind_tooth must be 3, 4, 5 or 6");
  return {.part = {},
          .cuts = {body_cut(site, Side::left), body_cut(site, Side::right)},
          .segments = proximal_and_distal(),
          .notes = {}};
}

}  // namespace

Recipe vertical_ramus_recipe() {
  return {"vertical_ramus", Jaw::lower, vertical_parameters(),
          [](Site& site) { return place_ramus_cuts(site, false); }};
}

Recipe inverted_l_recipe() {
  auto parameters = vertical_parameters();
  parameters.push_back(
      {"above_lingula_mm", "mm", "height of the horizontal cut above the lingula", 4, 1, 10});
  return {"inverted_l", Jaw::lower, parameters,
          [](Site& site) { return place_ramus_cuts(site, true); }};
}

Recipe body_recipe() {
  return {"body_osteotomy",
          Jaw::lower,
          {{"behind_tooth", "", "place of the tooth before the cut: 3 canine to 6 first molar", 3,
            3, 6},
           {"back_mm", "mm", "cut behind the middle of the gap", 0, -6, 6}},
          place_body};
}

}  // namespace condyle
