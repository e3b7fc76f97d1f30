#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/osteotomy/danger_zones.h"
#include "sim/osteotomy/interdental.h"
#include "sim/osteotomy/midface.h"
#include "sim/osteotomy/recipe.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The roof as a line in the midsagittal plane, from front to back.
std::vector<Vector3d> roof_line(const Site& site, const Midface& face) {
  const double half_kerf = 0.5 * site.kerf_mm;
  const Vector3d front(0, face.canine_y,
                       std::max(face.floor_z + site["above_floor_mm"],
                                face.canine_z + site["above_canine_mm"] + half_kerf));
  Vector3d back(0, face.molar_y, face.molar_z + site["above_molar_mm"] + half_kerf);
  if (site["step_mm"] == 0) {
    // Falling by 0 to 10 degrees to the back.
    const double run = back.y() - front.y();
    back.z() = std::clamp(back.z(), front.z() - std::tan(0.1745) * run, front.z());
    const Vector3d along = (back - front).normalized();
    return {front - 60 * along, back + 60 * along};
  }
  // Level in front, a step down at the crest, level behind it.
  const double crest_y = face.crest ? face.crest->y() : face.molar_y;
  const double low = std::max(front.z() - site["step_mm"], back.z());
  if (low > front.z() - 0.5)
    throw InputError(fmt::format("le_fort_1: no room for a step of {:g} mm above the molar roots",
                                 site["step_mm"]));
  return {{0, front.y() - 60, front.z()},
          {0, crest_y, front.z()},
          {0, crest_y, low},
          {0, face.back_y + 60, low}};
}

double height_at(const std::vector<Vector3d>& roof, double y) {
  double z = roof.back().z();
  for (std::size_t i = 0; i + 1 < roof.size(); ++i)
    if (y >= roof[i].y() && y < roof[i + 1].y())
      z = roof[i].z() +
          (y - roof[i].y()) / (roof[i + 1].y() - roof[i].y()) * (roof[i + 1].z() - roof[i].z());
  return z;
}

/// Below the roof, in front of the back wall, and inside of a crest that hangs below the roof.
Cut down_fracture(Site& site, const Midface& face, const std::vector<Vector3d>& roof) {
  const SurgicalAnatomy& jaw = site.anatomy;
  const Vector3d back(0, face.back_y + site["back_mm"], 0);
  Region maxilla = both(jaw.sheet(roof, Vector3d::UnitX(), -Vector3d::UnitZ(), 0),
                        jaw.above(back, -Vector3d::UnitY(), 8));
  if (face.crest && face.crest->z() < height_at(roof, face.crest->y()) - 3) {
    const double top = height_at(roof, face.crest->y()), x = face.widest_root + 3;
    for (const Side side : both_sides) {
      const double sign = sign_of(side);
      const Vector3d upper(sign * x, face.crest->y(), top),
          lower(sign * std::max(x, face.crest->x() - 1), face.crest->y(), face.crest->z());
      Vector3d inward = (upper - lower).cross(Vector3d::UnitY());
      if (inward.x() * sign > 0) inward = -inward;
      maxilla = both(std::move(maxilla), jaw.above(upper, inward, side == Side::left ? 9 : 10));
    }
  }
  const double wide = face.crest ? face.crest->x() + 10 : 55;
  return {"Le Fort I", std::move(maxilla),
          jaw.box({-wide, face.front_y - 20, face.incisal_z - 40},
                  {wide, back.y() + 2, std::max(roof.front().z(), roof[1].z()) + 8}),
          0};
}

/// What lies in the maxilla alone: the reach of cuts that divide it.
std::vector<Plane> within_maxilla(const SurgicalAnatomy& jaw, const Midface& face, const Site& site,
                                  const std::vector<Vector3d>& roof) {
  const Vector3d along = roof[1] - roof[0];
  Vector3d up = Vector3d::UnitX().cross(along);
  if (up.z() < 0) up = -up;
  return {jaw.plane(roof[0], up),
          jaw.plane({0, face.back_y + site["back_mm"], 0}, Vector3d::UnitY()),
          jaw.plane({0, face.front_y - 20, 0}, -Vector3d::UnitY()),
          jaw.plane({0, 0, face.incisal_z - 40}, -Vector3d::UnitZ())};
}

/// A cut between two teeth, which bends on the palate towards the midline.
struct PalatalCut {
  Vector3d gap, outside, bend;  // on the plane between the teeth
  Vector3d rising;              // the sheet's direction
};

PalatalCut palatal_cut(const Vector3d& point, const Vector3d& normal, const Vector3d& inward) {
  constexpr double behind_teeth_mm = 8;
  Vector3d along = normal.cross(Vector3d::UnitZ()).normalized();
  if (along.dot(inward) < 0) along = -along;
  Vector3d rising = normal.cross(along);
  if (rising.z() < 0) rising = -rising;
  return {point, point - 60 * along, point + behind_teeth_mm * along, rising};
}

/// Where a case does not have the teeth by themselves: between lateral incisor and canine.
Vector3d estimated_gap(SurgicalAnatomy& jaw, Side side) {
  const auto tip = jaw.find("upper_" + name_of(side) + "_canine_tip");
  const Vector3d incisal = jaw.need("upper_incisal_point");
  if (!tip) jaw.notes.push_back("the gap before the " + name_of(side) + " canine is estimated");
  return tip ? Vector3d(tip->x() - 4 * sign_of(side), tip->y() - 2, tip->z())
             : incisal + Vector3d(13 * sign_of(side), 5, 0);
}

/// Between lateral incisor and canine, or canine and first premolar.
PalatalCut interdental(Site& site, Side side, const Vector3d& inward) {
  SurgicalAnatomy& jaw = site.anatomy;
  const int first = (side == Side::left ? 20 : 10) + static_cast<int>(site["front_teeth"]);
  if (const auto plane = find_interdental(jaw, first, first + 1)) {
    jaw.rooms.push_back(room_text(*plane, site.kerf_mm));
    return palatal_cut(plane->point, plane->normal, inward);
  }
  const Vector3d gap = estimated_gap(jaw, side), apex(0, gap.y() + site["palate_mm"], 0);
  return palatal_cut(gap, Vector3d(gap.x(), gap.y() - apex.y(), 0).cross(Vector3d::UnitZ()),
                     inward);
}

/// The midline, between the central incisors.
Region midline_half(Site& site, const Midface& face) {
  SurgicalAnatomy& jaw = site.anatomy;
  const auto plane = find_interdental(jaw, 11, 21);
  if (!plane) return jaw.above(Vector3d::Zero(), Vector3d::UnitX(), interdental_wall);
  jaw.rooms.push_back(room_text(*plane, site.kerf_mm));
  const PalatalCut cut = palatal_cut(plane->point, plane->normal, Vector3d::UnitY());
  const std::vector<Vector3d> line{cut.outside, cut.bend,
                                   Vector3d(0, face.back_y + 10, cut.bend.z())};
  return jaw.sheet(line, cut.rising, Vector3d::UnitX(), interdental_wall);
}

PlacedOsteotomy place_le_fort_1(Site& site) {
  SurgicalAnatomy& jaw = site.anatomy;
  const Midface face = find_midface(jaw);
  const auto roof = roof_line(site, face);
  PlacedOsteotomy placed;
  placed.cuts.push_back(down_fracture(site, face, roof));
  const double pieces = site["pieces"];
  if (pieces != std::floor(pieces))
    throw InputError(fmt::format("le_fort_1: pieces is {:g}; expected 1, 2 or 3", pieces));
  if (site["front_teeth"] != std::floor(site["front_teeth"]))
    throw InputError("le_fort_1: front_teeth must be 2 or 3");
  if (pieces > 1 && site["step_mm"] != 0)
    throw InputError("le_fort_1: a stepped cut has one piece; set pieces to 1 or step_mm to 0");
  if (pieces == 1) {
    placed.segments = {{"maxilla", {CutSide::above}}};
    return placed;
  }
  auto reach = within_maxilla(jaw, face, site, roof);
  using enum CutSide;
  if (pieces == 2) {
    placed.cuts.push_back({"midline", midline_half(site, face), reach, 0});
    placed.segments = {{"maxilla_left", {above, above}}, {"maxilla_right", {above, below}}};
    return placed;
  }
  // The front within two sheets that meet on the palate; the rest in the midline.
  const PalatalCut left = interdental(site, Side::left, {-1, 1, 0}),
                   right = interdental(site, Side::right, {1, 1, 0});
  const double front_y = 0.5 * (left.bend.y() + right.bend.y()),
               gap_y = 0.5 * (left.gap.y() + right.gap.y());
  const Vector3d apex(0, std::max(front_y + 2, gap_y + site["palate_mm"]),
                      0.5 * (left.bend.z() + right.bend.z()));
  const auto within = [&](const PalatalCut& cut, double sign, int wall) {
    const std::vector<Vector3d> line{cut.outside, cut.bend, apex};
    return jaw.sheet(line, cut.rising, Vector3d(-sign, 0, 0), wall);
  };
  placed.cuts.push_back(
      {"interdental",
       both(within(left, 1, interdental_wall), within(right, -1, interdental_wall + 2)), reach, 0});
  // Both sheets and the midline share the line in which they meet.
  const Vector3d meeting = (apex - left.bend)
                               .cross(left.rising)
                               .cross((apex - right.bend).cross(right.rising))
                               .normalized();
  Vector3d midline = meeting.cross(Vector3d::UnitY()), front = meeting.cross(Vector3d::UnitX());
  if (midline.x() < 0) midline = -midline;
  if (front.y() > 0) front = -front;
  reach.push_back(jaw.plane(apex, front));
  placed.cuts.push_back({"midline", jaw.above(apex, midline, 0), reach, 0});
  placed.segments = {{"maxilla_front", {above, above, neither}},
                     {"maxilla_left", {above, below, above}},
                     {"maxilla_right", {above, below, below}}};
  return placed;
}

}  // namespace

Recipe le_fort_1_recipe() {
  return {
      "le_fort_1",
      Jaw::upper,
      {{"above_canine_mm", "mm", "roof above the canine apices", 5, 3, 12},
       {"above_molar_mm", "mm", "roof above the molar apices", 4.5, 3, 12},
       {"above_floor_mm", "mm", "roof above the floor of the nose, in front", 3, 0, 10},
       {"back_mm", "mm", "back wall behind the posterior nasal spine", 0.5, -4, 4},
       {"step_mm", "mm", "step down at the zygomatic buttress; 0: straight", 0, 0, 8},
       {"pieces", "", "pieces of the maxilla: 1, 2 (midline) or 3", 1, 1, 3},
       {"front_teeth", "", "of three pieces, last tooth of the front: 2 lateral incisor, 3 canine",
        2, 2, 3},
       {"palate_mm", "mm", "where the cuts of three pieces meet, behind the canines", 14, 6, 25}},
      place_le_fort_1};
}

}  // namespace condyle
