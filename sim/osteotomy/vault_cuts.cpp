#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/osteotomy/recipe.h"
#include "sim/osteotomy/vault.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

int whole_number(const Site& site, const std::string& osteotomy, const std::string& parameter) {
  const double value = site[parameter];
  if (value != std::floor(value))
    throw InputError(
        fmt::format("{}: {} is {:g}; expected a whole number", osteotomy, parameter, value));
  return static_cast<int>(value);
}

/// A part of the vault: front and back along the midline, distances from it.
struct PanelOutline {
  double front, back, near, far;
};

std::vector<Vault::Spot> samples(Vault& vault, const PanelOutline& outline) {
  constexpr int steps = 6;
  std::vector<Vault::Spot> spots;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j)
      spots.push_back(vault.spot(outline.front + i * (outline.back - outline.front) / steps,
                                 outline.near + j * (outline.far - outline.near) / steps));
  return spots;
}

Vector3d centre_of(Vault& vault, const PanelOutline& outline) {
  return vault.spot(0.5 * (outline.front + outline.back), 0.5 * (outline.near + outline.far)).at;
}

VaultBorder along_border(Vault& vault, const PanelOutline& outline, double beside) {
  return vault_border(vault, vault.spot(outline.front, beside).at,
                      vault.spot(outline.back, beside).at, centre_of(vault, outline));
}
VaultBorder across_border(Vault& vault, const PanelOutline& outline, double along) {
  return vault_border(vault, vault.spot(along, outline.near).at, vault.spot(along, outline.far).at,
                      centre_of(vault, outline));
}

Cut outlined_panel(const Site& site, Vault& vault, const std::string& name,
                   const PanelOutline& outline) {
  return panel_cut(
      site.anatomy, vault, name,
      {across_border(vault, outline, outline.front), across_border(vault, outline, outline.back),
       along_border(vault, outline, outline.near), along_border(vault, outline, outline.far)},
      samples(vault, outline));
}

/// The part of the vault between bregma and lambda.
std::pair<double, double> between_sutures(const Site& site, const Vault& vault,
                                          const std::string& osteotomy) {
  const double front = vault.bregma() + site["front_mm"], back = vault.lambda() - site["back_mm"];
  if (back < front + 30)
    throw InputError(
        fmt::format("{}: {:.0f} mm are left between front_mm and back_mm; 30 are needed", osteotomy,
                    back - front));
  return {front, back};
}

PlacedOsteotomy place_vault_strip(Site& site) {
  Vault vault(site.anatomy);
  const auto [front, back] = between_sutures(site, vault, "vault_strip");
  const double half = 0.5 * site["width_mm"];
  return {.part = {},
          .cuts = {outlined_panel(site, vault, "sagittal strip", {front, back, -half, half})},
          .segments = {{"strip", {CutSide::above}}},
          .notes = {}};
}

/// Panels of one side, from front to back: each shares its upper border with the strip or the other
/// side, and its front border with the one before it.
void add_side_panels(Site& site, Vault& vault, Side side, const PanelOutline& whole, int columns,
                     bool is_upper_shared, PlacedOsteotomy& placed) {
  const double step = (whole.back - whole.front) / columns;
  VaultBorder upper = along_border(vault, whole, whole.near);
  upper.is_shared = is_upper_shared;
  for (int i = 0; i < columns; ++i) {
    const PanelOutline outline{whole.front + i * step, whole.front + (i + 1) * step, whole.near,
                               whole.far};
    VaultBorder front = across_border(vault, outline, outline.front);
    front.is_shared = i > 0;
    const std::string number = columns > 1 ? fmt::format("_{}", i + 1) : "";
    placed.cuts.push_back(panel_cut(
        site.anatomy, vault,
        "parietal panel, " + name_of(side) + (columns > 1 ? fmt::format(" {}", i + 1) : ""),
        {upper, front, across_border(vault, outline, outline.back),
         along_border(vault, outline, outline.far)},
        samples(vault, outline)));
    placed.segments.push_back({"panel_" + name_of(side) + number, {}});
  }
}

PlacedOsteotomy place_vault_panels(Site& site) {
  Vault vault(site.anatomy);
  const auto [front, back] = between_sutures(site, vault, "vault_panels");
  const int columns = whole_number(site, "vault_panels", "columns");
  const double half = 0.5 * site["strip_mm"];
  PlacedOsteotomy placed;
  if (half > 0) {
    placed.cuts.push_back(
        outlined_panel(site, vault, "sagittal strip", {front, back, -half, half}));
    placed.segments.push_back({"strip", {}});
  }
  for (const Side side : both_sides) {
    const double sign = sign_of(side);
    const PanelOutline whole{front, back, sign * half, sign * (half + site["height_mm"])};
    add_side_panels(site, vault, side, whole, columns, half > 0 || side == Side::right, placed);
  }
  for (std::size_t i = 0; i < placed.segments.size(); ++i) {
    placed.segments[i].sides.assign(placed.cuts.size(), CutSide::neither);
    placed.segments[i].sides[i] = CutSide::above;
  }
  return placed;
}

/// A slit across the bone from one spot to another, open to both sides of the bone.
Cut slit(const SurgicalAnatomy& skull, const Vault& vault, const std::string& name,
         const std::vector<Vault::Spot>& spots) {
  const Vector3d start = spots.front().at, end = spots.back().at;
  VaultBorder wall = vault_border(vault, start, end, end + Vector3d::UnitY());
  const Vector3d along = (end - start).normalized();
  const auto ending = [&](const Vector3d& at, double sense) {
    const Vector3d out = vault.outward(at);
    return VaultBorder{at, sense * (along - along.dot(out) * out).normalized(), true};
  };
  Cut cut = panel_cut(skull, vault, name, {wall, ending(start, 1), ending(end, -1)}, spots);
  cut.reach.push_back(skull.plane(wall.point + vault_reach_mm * wall.inward, wall.inward));
  cut.ends_in_bone = true;
  return cut;
}

PlacedOsteotomy place_barrel_staves(Site& site) {
  Vault vault(site.anatomy);
  const auto [front, back] = between_sutures(site, vault, "barrel_staves");
  const int count = whole_number(site, "barrel_staves", "slits");
  constexpr double lowest_mm = 110, overlap_mm = 3;
  PlacedOsteotomy placed;
  for (const Side side : both_sides)
    for (int i = 0; i < count; ++i) {
      const double along =
          count == 1 ? 0.5 * (front + back) : front + i * (back - front) / (count - 1);
      const auto gap = vault.last_gap(along, side, lowest_mm - site["length_mm"]);
      const double start = gap ? *gap + 1 : site["start_mm"];
      std::vector<Vault::Spot> spots;
      // From a little before the free border.
      const double first = gap ? start - overlap_mm : start, last = start + site["length_mm"];
      for (int k = 0; k <= 10; ++k)
        spots.push_back(vault.spot(along, sign_of(side) * (first + k * (last - first) / 10)));
      placed.cuts.push_back(
          slit(site.anatomy, vault, fmt::format("stave slit, {} {}", name_of(side), i + 1), spots));
    }
  return placed;
}

constexpr double craniotome_mm = 1.2;

}  // namespace

Recipe vault_strip_recipe() {
  return {"vault_strip",
          Jaw::skull,
          {{"width_mm", "mm", "width of the strip along the sagittal suture", 40, 10, 80},
           {"front_mm", "mm", "front border behind bregma", 5, -20, 60},
           {"back_mm", "mm", "back border before lambda", 5, -20, 60}},
          place_vault_strip,
          craniotome_mm};
}

Recipe vault_panels_recipe() {
  return {"vault_panels",
          Jaw::skull,
          {{"strip_mm", "mm", "width of the sagittal strip; 0: the panels meet in the midline", 40,
            0, 80},
           {"height_mm", "mm", "height of the parietal panels along the bone", 60, 20, 90},
           {"columns", "", "panels of each side, from front to back", 1, 1, 4},
           {"front_mm", "mm", "front border behind bregma", 5, -20, 60},
           {"back_mm", "mm", "back border before lambda", 5, -20, 60}},
          place_vault_panels,
          craniotome_mm};
}

Recipe barrel_staves_recipe() {
  return {
      "barrel_staves",
      Jaw::skull,
      {{"slits", "", "slits of each side", 5, 1, 8},
       {"length_mm", "mm", "length of the slits along the bone", 40, 10, 70},
       {"start_mm", "mm", "start beside the midline, where no bone was removed above", 22, 0, 90},
       {"front_mm", "mm", "first slit behind bregma", 15, -20, 60},
       {"back_mm", "mm", "last slit before lambda", 15, -20, 60}},
      place_barrel_staves,
      2};
}

}  // namespace condyle
