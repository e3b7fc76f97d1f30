#include "sim/operation/cut_teeth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "engine/core/error.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "sim/osteotomy/danger_zones.h"
#include "sim/osteotomy/interdental.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Share of a tooth's surface beyond a cut up to which the cut grazes it.
constexpr double grazed_fraction = 0.01;

TriMesh submesh(const TriMesh& mesh, std::span<const int> triangles) {
  TriMesh part;
  part.vertices = mesh.vertices;
  part.colors = mesh.colors;
  for (const int t : triangles) part.triangles.push_back(mesh.triangles[t]);
  drop_unreferenced(part);
  return part;
}

Vector3d middle_of(const TriMesh& mesh, std::span<const int> triangles) {
  Vector3d sum = Vector3d::Zero();
  for (const int t : triangles)
    for (int k = 0; k < 3; ++k) sum += mesh.vertices[mesh.triangles[t][k]];
  return sum / (3.0 * static_cast<double>(triangles.size()));
}

bool in_reach(const Cut& cut, const Vector3d& p) {
  return std::all_of(cut.reach.begin(), cut.reach.end(),
                     [&](const Plane& plane) { return plane.distance(p) <= 0; });
}

/// Whether a point is above the walls, which are moved along their normals by `shift`.
bool is_above(const Cut& cut, const Vector3d& p, double shift) {
  std::vector<Region::Side> sides;
  for (const auto& leaf : cut.above.leaves()) {
    const bool upper = leaf.plane.distance(p) > (leaf.wall < 0 ? 0 : shift);
    sides.push_back(upper ? Region::Side::upper : Region::Side::lower);
  }
  return cut.above.evaluate(sides).inside;
}

bool is_interdental(const Cut& cut) {
  return std::any_of(cut.above.leaves().begin(), cut.above.leaves().end(),
                     [](const auto& leaf) { return leaf.wall >= interdental_wall; });
}

/// Whether more of the tooth than a graze lies beyond either wall. Between two teeth, crowns that
/// touch may reach a little beyond theirs.
bool divides(const Cut& cut, std::span<const Vector3d> points) {
  const double shift = 0.5 * cut.kerf_mm - (is_interdental(cut) ? grazed_crown_mm : 0);
  std::size_t not_above = 0, not_below = 0;
  for (const Vector3d& p : points) {
    if (!in_reach(cut, p)) continue;
    if (!is_above(cut, p, shift)) ++not_above;
    if (is_above(cut, p, -shift)) ++not_below;
  }
  const auto parted = static_cast<double>(std::min(not_above, not_below));
  return parted > grazed_fraction * static_cast<double>(points.size());
}

}  // namespace

std::vector<ArchItem> arch_items(const Part& part) {
  std::vector<ArchItem> items;
  std::vector<char> known(part.mesh.triangles.size(), 0);
  for (const Tooth& tooth : part.teeth) {
    items.push_back({tooth.fdi, std::vector<int>(tooth.triangle_count)});
    std::iota(items.back().triangles.begin(), items.back().triangles.end(), tooth.first_triangle);
    for (const int t : items.back().triangles) known[t] = 1;
  }
  std::vector<int> rest;
  for (std::size_t t = 0; t < known.size(); ++t)
    if (!known[t]) rest.push_back(static_cast<int>(t));
  if (rest.empty()) return items;
  const Components found = find_components(submesh(part.mesh, rest));
  const std::size_t first = items.size();
  items.resize(first + found.count);
  for (std::size_t i = 0; i < rest.size(); ++i)
    items[first + found.of_triangle[i]].triangles.push_back(rest[i]);
  return items;
}

std::vector<Vector3d> sample_points(const TriMesh& mesh, std::span<const int> triangles,
                                    std::size_t most) {
  std::vector<Vector3d> points;
  const std::size_t step = std::max<std::size_t>(1, 4 * triangles.size() / std::max(most, {1}));
  for (std::size_t i = 0; i < triangles.size(); i += step) {
    const Eigen::Vector3i& t = mesh.triangles[triangles[i]];
    Vector3d middle = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      points.push_back(mesh.vertices[t[k]]);
      middle += points.back() / 3;
    }
    points.push_back(middle);
  }
  return points;
}

void refuse_divided_teeth(const Part& teeth, std::span<const Cut> cuts,
                          std::span<const int> removed) {
  for (const ArchItem& item : arch_items(teeth)) {
    if (std::find(removed.begin(), removed.end(), item.fdi) != removed.end()) continue;
    const auto points = sample_points(teeth.mesh, item.triangles, 4 * item.triangles.size());
    for (const Cut& cut : cuts) {
      if (!divides(cut, points)) continue;
      const Vector3d at = middle_of(teeth.mesh, item.triangles);
      throw InputError(fmt::format(
          "the cut \"{}\" divides {} of {} near ({:.1f}, {:.1f}, {:.1f}); move the cut, or remove "
          "the tooth before it",
          cut.name, item.fdi > 0 ? fmt::format("tooth {}", item.fdi) : "a tooth", teeth.name,
          at.x(), at.y(), at.z()));
    }
  }
}

Part items_of_part(const Part& whole, std::span<const ArchItem> items, std::span<const int> of_item,
                   int value) {
  Part part{whole.name, whole.role, {}, {}, whole.body};
  std::vector<int> triangles;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (of_item[i] != value) continue;
    if (items[i].fdi > 0)
      part.teeth.push_back({items[i].fdi, static_cast<int>(triangles.size()),
                            static_cast<int>(items[i].triangles.size())});
    triangles.insert(triangles.end(), items[i].triangles.begin(), items[i].triangles.end());
  }
  part.mesh = submesh(whole.mesh, triangles);
  return part;
}

}  // namespace condyle
