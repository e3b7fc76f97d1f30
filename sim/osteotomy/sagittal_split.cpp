#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/osteotomy/ramus.h"
#include "sim/osteotomy/recipe.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double clear_of_bone_mm = 60;
/// Parameters of a side that shift its stations, from back to front.
constexpr const char* shifts[] = {"_ramus_mm", "_front_mm", "_body_mm"};

/// Where the split passes the bone of one side, from back to front.
struct Stations {
  Vector3d hind, lingula, front, buccal;
  Vector3d rising;      // the ramus' own direction, along which the sheet is extruded
  Vector3d on_body;     // the buccal station at the height of the body
  double plate_mm = 0;  // least thickness of bone outside the sheet; negative: it leaves the bone
};

/// Inclination of the outer surface between two heights, averaged over three places.
Vector3d rising_direction(const SurgicalAnatomy& jaw, Side side, const Ramus& ramus, double high,
                          double low) {
  double tilt = 0;
  int count = 0;
  for (const double y : {ramus.back - 4, ramus.lingula.y(), ramus.front + 3}) {
    const auto upper = jaw.crossings(side, y, high), lower = jaw.crossings(side, y, low);
    if (upper.size() < 2 || lower.size() < 2) continue;
    tilt += (upper[0] - lower[0]) / (high - low);
    ++count;
  }
  if (count) tilt /= count;
  return Vector3d(sign_of(side) * tilt, 0, 1).normalized();
}

/// Moves a depth outward, away from the canal, but leaves 2 mm of outer plate.
double clear_of_canal(const SurgicalAnatomy& jaw, Side side, double x, double y, double outer,
                      double margin_mm) {
  for (const auto& [point, margin] : jaw.canal_dangers(mandible_body, margin_mm))
    if (sign_of(side) * point.x() > 0 && std::abs(point.y() - y) < 3)
      x = std::max(x, std::min(sign_of(side) * point.x() + margin, outer - 2));
  return x;
}

/// Thickness of bone outside the sheet between two stations, by height; least of a segment. The
/// outer surface of the ramus is hollow, the sheet straight.
double thinnest_plate(const SurgicalAnatomy& jaw, Side side, const Vector3d& a, const Vector3d& b,
                      const Vector3d& rising, double high, double low) {
  double least = 100;
  for (int i = 0; i <= 4; ++i)
    for (int k = 0; k <= 8; ++k) {
      const double height = high + (low - high) * k / 8;
      Vector3d p = a + (b - a) * i / 4;
      p += rising * ((height - p.z()) / rising.z());
      const auto walls = jaw.crossings(side, p.y(), height);
      if (walls.size() < 2 || walls[0] - walls[1] < 4) continue;  // at a border
      least = std::min(least, walls[0] - sign_of(side) * p.x());
    }
  return least;
}

/// Moves the sheet inward in front of the canal, at most as far, until the plate has its thickness.
void thicken_plate(const Site& site, Side side, Stations& at, double high, double low) {
  constexpr double farthest_mm = 4, step_mm = 0.5;
  const double required = site["plate_mm"] + 0.5 * site.kerf_mm;
  const double start = at.front.x();
  for (double inward = 0; inward <= farthest_mm; inward += step_mm) {
    at.front.x() = start - sign_of(side) * inward;
    if (thinnest_plate(site.anatomy, side, at.lingula, at.front, at.rising, high, low) >= required)
      break;
  }
}

Stations find_stations(const Site& site, Side side, const Ramus& ramus, double buccal_y,
                       double top) {
  const SurgicalAnatomy& jaw = site.anatomy;
  const auto border = jaw.section(side, 1, buccal_y, 2, 10);
  if (!border)
    throw InputError("sagittal_split: the jaw has no bone at the buccal cut, " + name_of(side));
  const double low = border->low, high = top - 4;
  Stations stations;
  stations.rising = rising_direction(jaw, side, ramus, high - 2, low + 14);
  const auto station = [&](double y, double z, bool in_body) {
    const auto walls = jaw.crossings(side, y, z);
    if (walls.size() < 2)
      throw InputError(
          fmt::format("sagittal_split: no bone to split on the {} at a station", name_of(side)));
    const double thickness = walls[0] - walls[1];
    const double depth = in_body ? std::clamp(0.3 * thickness, 3.0, 4.5) : 0.5 * thickness;
    const double x = clear_of_canal(jaw, side, walls[0] - depth, y, walls[0],
                                    site["canal_margin_mm"] + 0.5 * site.kerf_mm);
    Vector3d p(sign_of(side) * x, y, z);
    return Vector3d(p - stations.rising * ((z - top) / stations.rising.z()));
  };
  stations.hind = station(ramus.back - 4, high, false);
  stations.lingula = station(ramus.lingula.y(), high, false);
  stations.front = station(ramus.front + 3, high, false);
  const double body_z = 0.5 * (high + low + 12) - 4;
  stations.buccal = station(buccal_y, body_z, true);
  thicken_plate(site, side, stations, high, low + 14);
  const std::pair<Vector3d*, const char*> moved[] = {{&stations.hind, shifts[0]},
                                                     {&stations.lingula, shifts[0]},
                                                     {&stations.front, shifts[1]},
                                                     {&stations.buccal, shifts[2]}};
  for (const auto& [place, name] : moved) place->x() += sign_of(side) * site[name_of(side) + name];
  stations.plate_mm = std::min(
      thinnest_plate(jaw, side, stations.lingula, stations.front, stations.rising, high, low + 14),
      thinnest_plate(jaw, side, stations.front, stations.buccal, stations.rising, body_z + 4,
                     low + 8));
  stations.on_body = stations.buccal + stations.rising * ((body_z - top) / stations.rising.z());
  return stations;
}

/// Between the first and second molar, or as far behind it as requested.
double buccal_place(SurgicalAnatomy& jaw, Side side, double back_mm) {
  const int second = side == Side::left ? 37 : 47;
  if (const auto tooth = jaw.tooth_middle(second)) return tooth->y() + back_mm;
  if (const auto cusp = jaw.find("lower_" + name_of(side) + "_first_molar_mesiobuccal_cusp"))
    return cusp->y() + 14 + back_mm;
  const std::string note = "the second molars are estimated: 38 mm behind the lower incisors";
  if (std::find(jaw.notes.begin(), jaw.notes.end(), note) == jaw.notes.end())
    jaw.notes.push_back(note);
  return jaw.need("lower_incisal_point").y() + 38 + back_mm;
}

Cut split_cut(Site& site, Side side, std::vector<CutStation>& stations) {
  SurgicalAnatomy& jaw = site.anatomy;
  const double sign = sign_of(side);
  const Ramus ramus = find_ramus(jaw, side);
  const double buccal = buccal_place(jaw, side, site["buccal_back_mm"]);
  const Vector3d medial(ramus.lingula.x(), ramus.lingula.y(),
                        ramus.lingula.z() + site["above_lingula_mm"]);
  const Stations at = find_stations(site, side, ramus, buccal, medial.z());
  const Vector3d backward = (at.hind - at.lingula).normalized(),
                 forward = (at.buccal - at.front).normalized();
  const Vector3d front_end = at.buccal + 8 * forward;
  // Behind the lingula Hunsuck's split turns inward and leaves through the medial cortex.
  const bool full = site["full"] != 0;
  const Vector3d turn = at.lingula + site["behind_lingula_mm"] * backward;
  const bool shifted = std::any_of(std::begin(shifts), std::end(shifts), [&](const char* name) {
    return site[name_of(side) + name] != 0;
  });
  if (shifted && at.plate_mm < 0)
    jaw.notes.push_back(
        fmt::format("the split on the {} lies up to {:.1f} mm outside the bone between its "
                    "stations: less lateral shift keeps it within",
                    name_of(side), -at.plate_mm));
  // On the ramus below the medial cut, above which there is no split.
  const Vector3d below = -5 * at.rising;
  const Vector3d places[] = {(full ? at.lingula : turn) + below, at.front + below, at.on_body};
  for (int i = 0; i < 3; ++i)
    stations.push_back(jaw.station(name_of(side) + shifts[i], places[i], sign * Vector3d::UnitX()));
  std::vector<Vector3d> line;
  Vector3d outside(sign, 0, 0);
  if (full) {
    line = {at.hind + 11 * backward, at.lingula, at.front, at.buccal, front_end};
  } else {
    line = {turn + Vector3d(-25 * sign, 6, 0), turn, at.front, at.buccal, front_end};
    outside = Vector3d::UnitY();
  }
  const Vector3d across(-forward.x(), -forward.y(), 0);
  const Region proximal =
      either(jaw.above(medial, occlusal_up(jaw), 0),
             both(jaw.sheet(line, at.rising, outside, 1), jaw.above(at.buccal, across, 8)));
  Vector3d low(8, buccal - 14, ramus.lingula.z() - clear_of_bone_mm),
      high(8 + 3 * clear_of_bone_mm, ramus.back + clear_of_bone_mm,
           ramus.lingula.z() + 2 * clear_of_bone_mm);
  if (side == Side::right) {
    std::swap(low.x(), high.x());
    low.x() = -low.x(), high.x() = -high.x();
  }
  Cut cut{"sagittal split, " + name_of(side), proximal, jaw.box(low, high), 0};
  cut.stays_in_bone = true;
  return cut;
}

PlacedOsteotomy place_sagittal_split(Site& site) {
  PlacedOsteotomy placed;
  for (const Side side : {Side::left, Side::right})
    placed.cuts.push_back(split_cut(site, side, placed.stations));
  placed.segments = proximal_and_distal();
  return placed;
}

}  // namespace

Recipe sagittal_split_recipe() {
  return {
      "sagittal_split",
      Jaw::lower,
      {{"above_lingula_mm", "mm", "height of the medial cut above the lingula", 4, 1, 10},
       {"behind_lingula_mm", "mm", "where the split turns out through the medial cortex", 6, 3, 10},
       {"full", "", "1: the split runs through the posterior border; 0: it ends as Hunsuck's", 0, 0,
        1},
       {"buccal_back_mm", "mm", "buccal cut behind the middle of the second molar", 0, -12, 12},
       {"left_ramus_mm", "mm", "lateral shift of the split behind the lingula, left", 0, -4, 4},
       {"left_front_mm", "mm", "lateral shift of the split at the front of the ramus, left", 0, -4,
        4},
       {"left_body_mm", "mm", "lateral shift of the split in the body, left", 0, -4, 4},
       {"right_ramus_mm", "mm", "lateral shift of the split behind the lingula, right", 0, -4, 4},
       {"right_front_mm", "mm", "lateral shift of the split at the front of the ramus, right", 0,
        -4, 4},
       {"right_body_mm", "mm", "lateral shift of the split in the body, right", 0, -4, 4},
       {"plate_mm", "mm", "thickness of bone outside the split that is kept where it can be", 0.5,
        0, 4},
       {"canal_margin_mm", "mm", "distance from the wall of the canal that is kept where it can be",
        1, 0, 4}},
      place_sagittal_split};
}

}  // namespace condyle
