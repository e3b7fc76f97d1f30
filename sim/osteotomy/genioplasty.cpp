#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/osteotomy/recipe.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The lowest point of the symphysis.
Vector3d menton_of(SurgicalAnatomy& jaw) {
  if (const auto menton = jaw.find("menton")) return {0, menton->y(), menton->z()};
  std::optional<Vector3d> lowest;
  for (const Side side : both_sides)
    if (const auto range = jaw.section(side, 0, 0, 2, -1))
      if (!lowest || range->low < lowest->z()) lowest = range->low_at;
  if (!lowest) throw InputError("the case lacks the landmark menton");
  jaw.notes.push_back("menton is estimated: the lowest point of the symphysis");
  return {0, lowest->y(), lowest->z()};
}

/// Both mental foramina as a point of the left side. Estimated, it lies on the outer surface, 0.18
/// of the way back from pogonion to the condyles and 0.45 of the way up from menton to the incisal
/// edges, as on the built-in patient.
Vector3d foramen_of(SurgicalAnatomy& jaw, const Vector3d& menton) {
  if (const auto foramen = jaw.find("left_mental_foramen"))
    if (const auto right = jaw.find("right_mental_foramen"))
      return {std::min(foramen->x(), -right->x()), 0.5 * (foramen->y() + right->y()),
              std::min(foramen->z(), right->z())};
  const Vector3d pogonion = jaw.need("pogonion"), incisal = jaw.need("lower_incisal_point");
  const double back = 0.5 * (jaw.need("left_condyle").y() + jaw.need("right_condyle").y());
  Vector3d foramen(0, pogonion.y() + 0.18 * (back - pogonion.y()),
                   menton.z() + 0.45 * (incisal.z() - menton.z()));
  const auto surface = jaw.crossings(Side::left, foramen.y(), foramen.z());
  if (surface.empty()) throw InputError("the case lacks the landmark left_mental_foramen");
  foramen.x() = surface.front();
  jaw.notes.push_back("the mental foramina are estimated from pogonion, menton and incisal edges");
  return foramen;
}

/// What the flat part must pass below: canine roots, foramina and canals.
std::vector<SurgicalAnatomy::Danger> dangers_above(const Site& site, const Vector3d& foramen) {
  const SurgicalAnatomy& jaw = site.anatomy;
  std::vector<SurgicalAnatomy::Danger> dangers;
  for (const int fdi : {31, 32, 33, 34, 41, 42, 43, 44})
    for (const auto& p : jaw.tooth_points(fdi)) dangers.push_back({p, site["root_margin_mm"]});
  for (const char* name : {"lower_left_canine_apex", "lower_right_canine_apex"})
    if (const auto apex = jaw.find(name)) dangers.push_back({*apex, site["root_margin_mm"]});
  dangers.push_back({foramen, site["foramen_margin_mm"]});
  for (const auto& canal : jaw.canal_dangers(mandible_body, site["canal_margin_mm"]))
    if (std::abs(canal.point.x()) < foramen.x() && canal.point.y() < foramen.y() + 12)
      dangers.push_back(canal);
  return dangers;
}

/// Where the side parts leave the bone: the lower border below the first molar.
Vector3d border_of(SurgicalAnatomy& jaw) {
  Vector3d molar = Vector3d::Zero();
  if (const auto left = jaw.find("lower_left_first_molar_mesiobuccal_cusp")) {
    molar = *left;
  } else {
    molar = jaw.need("lower_incisal_point") + Vector3d(0, 30, 0);
    jaw.notes.push_back("the first molars are estimated: 30 mm behind the lower incisors");
  }
  std::optional<SurgicalAnatomy::Range> border;
  for (const Side side : both_sides)
    if (const auto range = jaw.section(side, 1, molar.y(), 2, 5))
      if (!border || range->low < border->low) border = range;
  if (!border) throw InputError("genioplasty: the jaw has no lower border below the first molar");
  return {std::abs(border->low_at.x()), border->low_at.y(), border->low_at.z()};
}

PlacedOsteotomy place_genioplasty(Site& site) {
  SurgicalAnatomy& jaw = site.anatomy;
  const Vector3d menton = menton_of(jaw), foramen = foramen_of(jaw, menton);
  const Vector3d border = border_of(jaw);
  const double front =
      jaw.find("pogonion") ? jaw.find("pogonion")->y() : menton.y() - 5;  // the sheet's points
  const double fall = std::tan(site["tilt_deg"] * 3.14159265358979323846 / 180);
  const double cosine = 1 / std::sqrt(1 + fall * fall), half_kerf = 0.5 * site.kerf_mm;
  double height = menton.z() + site["height_mm"];
  const double requested = height;
  for (const auto& [point, margin] : dangers_above(site, foramen))
    height =
        std::min(height, point.z() - (margin + half_kerf) / cosine + fall * (point.y() - front));
  if (height < requested - 0.05)
    jaw.notes.push_back(
        fmt::format("the cut is {:.1f} mm above menton, below roots, foramina and "
                    "canal; {:.1f} mm were requested",
                    height - menton.z(), requested - menton.z()));
  if (height < menton.z() + 4)
    throw InputError(fmt::format(
        "genioplasty: {:.1f} mm of chin are left below roots, foramina and canal; 4 are needed",
        height - menton.z()));
  // From bend to bend flat, then falling to the border and as much beyond it.
  const Vector3d along(0, 1, -fall);
  const double at_border = std::max(border.x(), foramen.x() + 5);
  const double far = at_border + 15 + std::max({0.0, site["left_bend_mm"], site["right_bend_mm"]});
  std::vector<Vector3d> line(4);  // from the right to the left
  std::vector<CutStation> stations;
  for (const Side side : both_sides) {
    const std::string bend_name = name_of(side) + "_bend_mm", end_name = name_of(side) + "_end_mm";
    const double bend = foramen.x() + site[bend_name], out = std::max(at_border, bend + 5),
                 leaves = border.z() + fall * (border.y() - front),
                 slope = std::max(0.2, (height - leaves) / (out - bend)) -
                         site[end_name] / (out - bend);
    const Vector3d turn(sign_of(side) * bend, front, height);
    line[side == Side::left ? 2 : 1] = turn;
    line[side == Side::left ? 3 : 0] =
        Vector3d(sign_of(side) * far, front, height - slope * (far - bend));
    stations.push_back(jaw.station(bend_name, turn + (foramen.y() - front) * along,
                                   sign_of(side) * Vector3d::UnitX()));
    const Vector3d end(sign_of(side) * out, front, height - slope * (out - bend));
    stations.push_back(
        jaw.station(end_name, end + (border.y() - front) * along, Vector3d::UnitZ()));
  }
  Cut cut{"genioplasty", jaw.sheet(line, along, -Vector3d::UnitZ(), 0),
          jaw.box({-far - 1, front - 20, menton.z() - 25}, {far + 1, front + 60, height + 12}), 0};
  return {.part = {},
          .cuts = {cut},
          .segments = {{"chin", {CutSide::above}}},
          .notes = {},
          .stations = std::move(stations)};
}

}  // namespace

Recipe genioplasty_recipe() {
  return {"genioplasty",
          Jaw::lower,
          {{"height_mm", "mm", "height of the flat part above menton", 14.5, 6, 25},
           {"tilt_deg", "deg", "fall of the cut towards the back", 8.5, -10, 25},
           {"left_bend_mm", "mm", "left bend, lateral to the mental foramen", 0, -12, 12},
           {"right_bend_mm", "mm", "right bend, lateral to the mental foramen", 0, -12, 12},
           {"left_end_mm", "mm", "left end, height above the lower border below the first molar", 0,
            -12, 12},
           {"right_end_mm", "mm", "right end, height above the lower border below the first molar",
            0, -12, 12},
           {"root_margin_mm", "mm", "least distance from roots", 5, 3, 12},
           {"foramen_margin_mm", "mm", "least distance from the mental foramina", 5, 3, 12},
           {"canal_margin_mm", "mm", "least distance from the wall of the canal", 2, 1, 6}},
          place_genioplasty};
}

}  // namespace condyle
