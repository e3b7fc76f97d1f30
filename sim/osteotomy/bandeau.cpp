#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/osteotomy/recipe.h"
#include "sim/osteotomy/vault.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Where the fronto-orbital bandeau lies: points of the left side stand for both.
struct Bandeau {
  double low_z, high_z;  // of the bar
  double back_y;         // wall through the roofs of the orbits
  double side_y;         // end of the bar's full height at the temples
  double inner_x;        // between the roof of the orbit and the temple's inner table
  Vector3d temple;       // outer surface at the end of the bar's upper border
  double front_y, wide;  // of the skull there
};

/// Highest points of the upper margins of the orbits.
Vector3d upper_margin(SurgicalAnatomy& skull) {
  if (const auto margin = skull.find_middle("orbit_roof_margin"))
    return {skull.find("left_orbit_roof_margin")->x(), margin->y(), margin->z()};
  const Vector3d left = skull.need("left_orbitale"), right = skull.need("right_orbitale");
  skull.notes.push_back("the upper orbital margins are estimated: 34 mm above the orbitales");
  return {0.5 * (left.x() - right.x()), 0.5 * (left.y() + right.y()),
          0.5 * (left.z() + right.z()) + 34};
}

Bandeau find_bandeau(const Site& site, SurgicalAnatomy& skull) {
  const Vector3d margin = upper_margin(skull);
  Bandeau bar{};
  bar.high_z = margin.z() + site["above_rim_mm"];
  bar.low_z = bar.high_z - site["height_mm"];
  const double middle_z = 0.5 * (bar.low_z + bar.high_z);
  const TriangleTree tree(skull.bone());
  const auto front = tree.ray_cast({margin.x(), -400, middle_z}, Vector3d::UnitY(), 800);
  const auto glabella = tree.ray_cast({0, -400, middle_z}, Vector3d::UnitY(), 800);
  if (!front || !glabella) throw InputError("bandeau: the skull has no forehead above the orbits");
  bar.front_y = std::min(front->point.y(), glabella->point.y());
  bar.back_y = front->point.y() + site["depth_mm"];
  bar.side_y = front->point.y() + site["side_mm"];
  bar.inner_x = 1e9;
  for (const Side side : both_sides) {
    const auto walls = skull.crossings(side, bar.side_y, middle_z);
    // The frontal cut passes obliquely through the temple and must meet the bar all the way.
    const double temple_y = bar.side_y - 10;
    const auto upper = skull.crossings(side, temple_y, bar.high_z);
    if (walls.empty() || upper.empty())
      throw InputError(fmt::format("bandeau: no bone at the {} temple", name_of(side)));
    // Where the forehead turns to the temple its section is long.
    for (double y = bar.back_y; y < bar.side_y + 1; y += 1)
      for (const double z : {middle_z, bar.high_z}) {
        const auto section = skull.crossings(side, y, z);
        if (section.size() < 2) continue;
        bar.inner_x = std::min(bar.inner_x, std::max(section[1], section[0] - 25) - 4);
      }
    if (side == Side::left) bar.temple = {upper[0], temple_y, bar.high_z};
    bar.wide = std::max(bar.wide, walls[0] + 30);
  }
  return bar;
}

/// The bar in front of the roofs' wall, and at each temple back to its end, from which a lower
/// tenon goes on.
Cut bandeau_cut(const Site& site, const SurgicalAnatomy& skull, const Bandeau& bar) {
  const Vector3d up = Vector3d::UnitZ(), back = Vector3d::UnitY();
  const double middle_z = 0.5 * (bar.low_z + bar.high_z), half = 0.5 * site["tenon_height_mm"];
  const double end_y = bar.side_y + site["tenon_mm"];
  const auto before = [&](double y, int wall) { return skull.above({0, y, 0}, -back, wall); };
  Region bone = before(bar.back_y, 2);
  for (const Side side : both_sides) {
    const int first = side == Side::left ? 3 : 8;
    Region temple = before(bar.side_y, first + 1);
    if (site["tenon_mm"] > 0)
      temple =
          either(std::move(temple), both(both(skull.above({0, 0, middle_z - half}, up, first + 2),
                                              skull.above({0, 0, middle_z + half}, -up, first + 3)),
                                         before(end_y, first + 4)));
    bone =
        either(std::move(bone),
               both(skull.above({sign_of(side) * bar.inner_x, 0, 0}, {sign_of(side), 0, 0}, first),
                    std::move(temple)));
  }
  return {"bandeau",
          both(both(skull.above({0, 0, bar.low_z}, up, 0), skull.above({0, 0, bar.high_z}, -up, 1)),
               std::move(bone)),
          skull.box({-bar.wide, bar.front_y - vault_reach_mm, bar.low_z - vault_reach_mm},
                    {bar.wide, end_y + vault_reach_mm, bar.high_z + vault_reach_mm}),
          0};
}

/// The frontal bone above the bandeau, in front of the coronal suture: it shares the bar's upper
/// kerf.
Cut frontal_cut(const Site& site, SurgicalAnatomy& skull, const Bandeau& bar) {
  Vault vault(skull);
  const double along = vault.bregma() - site["coronal_mm"];
  const Vector3d top = vault.spot(along, 0).at, inside(0, bar.front_y, bar.high_z);
  std::vector<Vault::Spot> spots{{inside, 10, true}};
  std::vector<VaultBorder> borders{{{0, 0, bar.high_z}, Vector3d::UnitZ(), true}};
  for (const double sign : {1., -1.}) {
    const Vector3d temple(sign * bar.temple.x(), bar.temple.y(), bar.temple.z());
    borders.push_back(vault_border(vault, top, temple, inside));
    spots.push_back({temple, 10, true});
  }
  for (int k = 1; k <= 8; ++k) spots.push_back(vault.spot(along * k / 8, 0));
  return panel_cut(skull, vault, "frontal bone", borders, spots);
}

PlacedOsteotomy place_bandeau(Site& site) {
  SurgicalAnatomy& skull = site.anatomy;
  if (site["frontal"] != 0 && site["frontal"] != 1)
    throw InputError(fmt::format("bandeau: frontal is {:g}; expected 0 or 1", site["frontal"]));
  if (site["tenon_height_mm"] > site["height_mm"])
    throw InputError("bandeau: tenon_height_mm is larger than height_mm");
  const Bandeau bar = find_bandeau(site, skull);
  using enum CutSide;
  PlacedOsteotomy placed;
  placed.cuts.push_back(bandeau_cut(site, skull, bar));
  if (site["frontal"] == 0) {
    placed.segments = {{"bandeau", {above}}};
    return placed;
  }
  placed.cuts.push_back(frontal_cut(site, skull, bar));
  placed.segments = {{"bandeau", {above, neither}}, {"frontal_bone", {neither, above}}};
  return placed;
}

}  // namespace

Recipe bandeau_recipe() {
  return {
      "bandeau",
      Jaw::skull,
      {{"above_rim_mm", "mm", "upper border above the upper orbital margins", 12, 8, 25},
       {"height_mm", "mm", "height of the bar", 14, 8, 25},
       {"depth_mm", "mm", "wall through the roofs of the orbits, behind their margins", 14, 6, 25},
       {"side_mm", "mm", "end of the bar at the temples, behind the orbital margins", 24, 10, 45},
       {"tenon_mm", "mm", "length of the tenons behind that end; 0: none", 15, 0, 30},
       {"tenon_height_mm", "mm", "height of the tenons", 7, 3, 15},
       {"frontal", "", "1: the frontal bone above is cut out, too; 0: the bar alone", 1, 0, 1},
       {"coronal_mm", "mm", "upper border of the frontal bone before bregma", 10, 0, 60}},
      place_bandeau,
      1.2};
}

}  // namespace condyle
