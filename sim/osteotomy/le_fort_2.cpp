#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/mesh/triangle_tree.h"
#include "sim/osteotomy/midface.h"
#include "sim/osteotomy/recipe.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Vector3d mirrored(const Vector3d& p) { return {-p.x(), p.y(), p.z()}; }

/// The upper border of the pyramid, from the midline to the left, in the frontal plane: root of the
/// nose, orbital margin medial of the infraorbital foramen, below it, and below the zygoma.
std::vector<Vector3d> pyramid_line(const Site& site, SurgicalAnatomy& skull, const Midface& face) {
  const double half_kerf = 0.5 * site.kerf_mm, from_foramen = site["foramen_margin_mm"] + half_kerf;
  const double root_z = skull.need("nasion").z() - site["below_nasion_mm"];
  const auto left = skull.find("left_infraorbital_foramen"),
             right = skull.find("right_infraorbital_foramen");
  const Vector3d orbitale = paired_point(skull, "orbitale");
  Vector3d foramen = orbitale + Vector3d(-5, 0, -9);
  if (left && right)
    foramen = {std::min(left->x(), -right->x()), left->y(), std::min(left->z(), right->z())};
  else
    skull.notes.push_back("the infraorbital foramina are estimated: 9 mm below the orbitales");
  double medial_x = foramen.x() - 15;
  if (const auto rim = skull.find("left_orbit_medial_rim")) medial_x = rim->x();
  const double low_z = std::max(face.molar_z + site["above_molar_mm"] + half_kerf,
                                face.crest ? face.crest->z() + 2 : -1e9);
  const Vector3d root(medial_x, 0, root_z), rim(foramen.x() - from_foramen, 0, orbitale.z() + 4),
      medial(foramen.x() - from_foramen, 0, foramen.z() - 1),
      below(foramen.x() + 1, 0, std::max(foramen.z() - 1.3 * from_foramen, low_z + 0.5)),
      lateral(foramen.x() + 60, 0, low_z);
  return {root, rim, medial, below, lateral};
}

PlacedOsteotomy place_le_fort_2(Site& site) {
  SurgicalAnatomy& skull = site.anatomy;
  const Midface face = find_midface(skull);
  const auto half = pyramid_line(site, skull, face);
  std::vector<Vector3d> line;
  for (auto p = half.rbegin(); p != half.rend(); ++p) line.push_back(mirrored(*p));
  line.insert(line.end(), half.begin(), half.end());
  const Vector3d orbitale = paired_point(skull, "orbitale"), nasion = skull.need("nasion");
  double medial_y = nasion.y() + 8;
  if (const auto rim = skull.find_middle("orbit_medial_rim")) medial_y = rim->y();
  const double crest_y = medial_y + site["lacrimal_mm"], back_y = face.back_y + site["back_mm"];
  // From the medial wall of the orbit down and back to the pterygomaxillary fissure.
  const double fissure_z = std::max(face.molar_z + 8, face.floor_z + 4);
  const std::vector<Vector3d> back = {{0, crest_y, nasion.z() + 60},
                                      {0, crest_y, orbitale.z() - 1},
                                      {0, back_y, fissure_z},
                                      {0, back_y, fissure_z - 100}};
  const double wide = (face.crest ? face.crest->x() : face.widest_root + 12) + 20;
  const Vector3d down = -Vector3d::UnitZ(), forward = -Vector3d::UnitY();
  return {.part = {},
          .cuts = {{"Le Fort II",
                    both(skull.sheet(line, Vector3d::UnitY(), down, 0),
                         skull.sheet(back, Vector3d::UnitX(), forward, 20)),
                    skull.box({-wide, face.front_y - 25, face.incisal_z - 40},
                              {wide, back_y + 2, nasion.z() + 12}),
                    0}},
          .segments = {{"midface", {CutSide::above}}},
          .notes = {}};
}

/// What the Le Fort III is placed by, on the left side for both.
struct UpperFace {
  Vector3d suture;   // frontozygomatic
  Vector3d fissure;  // floor of the orbit at the inferior fissure
  double arch_x, arch_y;
};

UpperFace find_upper_face(const Site& site, SurgicalAnatomy& skull, double back_y) {
  UpperFace face{};
  const Vector3d orbitale = paired_point(skull, "orbitale");
  if (skull.find_middle("frontozygomatic")) {
    face.suture = paired_point(skull, "frontozygomatic");
  } else {
    face.suture = orbitale + Vector3d(21, 11, 23);
    skull.notes.push_back(
        "the frontozygomatic sutures are estimated: 23 mm above and 21 mm beside the orbitales");
  }
  face.fissure = orbitale + Vector3d(0, site["fissure_mm"], 6);
  const TriangleTree tree(skull.bone());
  const Vector3d above = face.fissure + Vector3d(0, 0, 10);
  if (const auto floor = tree.ray_cast(above, -Vector3d::UnitZ(), 25))
    face.fissure.z() = floor->point.z();
  double zygion_x = face.suture.x() + 11;
  if (skull.find_middle("zygion")) zygion_x = paired_point(skull, "zygion").x();
  face.arch_x = zygion_x - 13;
  face.arch_y = std::max(face.suture.y() + site["arch_mm"], back_y + 4);
  return face;
}

Cut arch_cut(const SurgicalAnatomy& skull, const UpperFace& face, Side side) {
  const double sign = sign_of(side);
  Vector3d low(sign * face.arch_x, face.arch_y - 1, face.suture.z() - 55),
      high(sign * (face.arch_x + 40), face.arch_y + 12, face.suture.z() - 8);
  if (side == Side::right) std::swap(low.x(), high.x());
  return {"zygomatic arch, " + name_of(side),
          skull.above({0, face.arch_y, 0}, -Vector3d::UnitY(), 0), skull.box(low, high), 0};
}

PlacedOsteotomy place_le_fort_3(Site& site) {
  SurgicalAnatomy& skull = site.anatomy;
  const Midface face = find_midface(skull);
  const double back_y = face.back_y + site["back_mm"];
  const UpperFace upper = find_upper_face(site, skull, back_y);
  const Vector3d nasion = skull.need("nasion");
  const Vector3d root(0, nasion.y(), nasion.z() - site["below_nasion_mm"]),
      fissure(0, upper.fissure.y(), upper.fissure.z()),
      suture(0, upper.suture.y() + 6, upper.suture.z() + site["above_suture_mm"]);
  const Vector3d pterygoid(0, back_y, std::min(fissure.z() - 8, face.floor_z + 14));
  const Vector3d end = pterygoid - Vector3d(0, 0, 120), before(0, 60, 0);
  const std::vector<Vector3d> central = {root - before, root, fissure, pterygoid, end},
                              lateral = {suture - before, suture, fissure, pterygoid, end};
  const Vector3d below = -Vector3d::UnitZ();
  const auto choose_beyond = [&](double x, Region out, Region in) {
    Region left = Region::choose(skull.plane({x, 0, 0}, Vector3d::UnitX()), out, in);
    return Region::choose(skull.plane({-x, 0, 0}, -Vector3d::UnitX()), out, std::move(left));
  };
  // Farther out than the orbit is the cheek bone, which the cuts of the arches part.
  Region midface = choose_beyond(
      upper.arch_x, skull.above(suture, below, 20),
      choose_beyond(upper.fissure.x(), skull.sheet(lateral, Vector3d::UnitX(), below, 10),
                    skull.sheet(central, Vector3d::UnitX(), below, 0)));
  const double wide = upper.arch_x + 40;
  PlacedOsteotomy placed;
  placed.cuts.push_back({"Le Fort III", std::move(midface),
                         skull.box({-wide, face.front_y - 25, face.incisal_z - 40},
                                   {wide, back_y + 2, nasion.z() + 12}),
                         0});
  for (const Side side : both_sides) placed.cuts.push_back(arch_cut(skull, upper, side));
  placed.segments = {{"midface", {CutSide::above, CutSide::neither, CutSide::neither}}};
  return placed;
}

}  // namespace

Recipe le_fort_2_recipe() {
  return {
      "le_fort_2",
      Jaw::skull,
      {{"below_nasion_mm", "mm", "cut through the root of the nose below nasion", 2, -3, 8},
       {"lacrimal_mm", "mm", "cut of the medial orbital wall behind its margin", 10, 4, 16},
       {"foramen_margin_mm", "mm", "distance from the infraorbital foramina, about", 8.5, 4, 12},
       {"above_molar_mm", "mm", "lateral cut above the molar apices", 5, 3, 12},
       {"back_mm", "mm", "back wall behind the posterior nasal spine", 0.5, -4, 4}},
      place_le_fort_2};
}

Recipe le_fort_3_recipe() {
  return {"le_fort_3",
          Jaw::skull,
          {{"below_nasion_mm", "mm", "cut through the root of the nose below nasion", 2, -3, 8},
           {"above_suture_mm", "mm", "lateral cut above the frontozygomatic suture", 0, -6, 6},
           {"fissure_mm", "mm", "cut of the orbital floor behind the lower margin", 22, 12, 32},
           {"arch_mm", "mm", "cuts of the arches behind the frontozygomatic suture", 28, 12, 50},
           {"back_mm", "mm", "back wall behind the posterior nasal spine", 0.5, -4, 4}},
          place_le_fort_3};
}

}  // namespace condyle
