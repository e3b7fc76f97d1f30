#include "sim/dental_scan/carried_crowns.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "engine/cut/cell_complex.h"
#include "engine/cut/cut.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/dental_scan/crown_points.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int sample_count = 8000;
constexpr double section_mm = 8;
constexpr double arch_end_mm = 16;         // behind: second and third molars, with the ramus beside
constexpr double top_reach_mm = 4;         // within which the tips count for the floor of a section
constexpr double ceiling_mm = 10;          // above the crowns: lumps of streaks
constexpr double beyond_mm = 0.5;          // reach of the cuts beyond the space
constexpr double near_teeth_mm = 1.5;      // a scanned crown is one of the case's this near to them
constexpr double in_bone_mm = 0.5;         // or this near to bone
constexpr double least_above_mm = 1;       // the floor: a crest of bone may reach this far
constexpr double set_free_fraction = 0.1;  // of the largest piece's volume
constexpr int sides = 8;

/// Part of an arch: an octagon seen along the bite's direction.
struct CrownSection {
  std::array<double, sides> extent;  // of the crowns along each direction across the bite
  double floor = 0, top = 0;         // along the bite
  double tube_mm = crown_tube_mm;
};

Box box_round(const TriMesh& crowns) {
  constexpr double around_mm = 10;
  Box box = bounding_box(crowns);
  box.low -= Vector3d::Constant(around_mm);
  box.high += Vector3d::Constant(around_mm);
  return box;
}

bool meet(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

class CrownSpace {
 public:
  CrownSpace(const ReplacingCrowns& crowns, const TriangleTree& bone)
      : box_(box_round(crowns.scan)),
        bite_(bite_of(crowns)),
        right_(bite_.unitOrthogonal()),
        up_(bite_.cross(right_)) {
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      directions_[k] = std::cos(angle) * right_ + std::sin(angle) * up_;
    }
    find_sections(crowns, bone);
  }

  /// The sections that a bone reaches, as saw cuts.
  std::vector<Cut> cuts_of(const TriMesh& bone) const {
    std::vector<char> reached(sections_.size(), 0);
    const auto mark = [&](const Vector3d& p) {
      for (std::size_t i = 0; i < sections_.size(); ++i)
        if (!reached[i]) reached[i] = holds(sections_[i], p);
    };
    for (const auto& t : bone.triangles) mark_triangle(bone, t, mark);
    std::vector<Cut> cuts;
    for (std::size_t i = 0; i < sections_.size(); ++i)
      if (reached[i]) cuts.push_back(cut_of(sections_[i], static_cast<int>(i)));
    return cuts;
  }

 private:
  using Points = std::vector<Vector3d>;

  /// Of the scan, whose plane is better known than that of the case's crowns.
  static Vector3d bite_of(const ReplacingCrowns& crowns) {
    const Vector3d normal = flat_normal(crowns.scan);
    return normal.dot(crowns.bite) < 0 ? Vector3d(-normal) : normal;
  }

  /// Sections in which the case has crowns, or bone that carries them: not those on the gum of a
  /// gap, or parts of such.
  void find_sections(const ReplacingCrowns& crowns, const TriangleTree& bone) {
    const TriangleTree teeth(crowns.before);
    std::map<std::pair<int, int>, std::array<Points, 2>> cells;  // on gum, on crowns
    const Points points = crown_points(crowns.scan, bite_, sample_count).points.points;
    double rear = -1e9;
    for (const auto& p : points) {
      rear = std::max(rear, p.y());
      const bool on_crown = teeth.nearest(p, near_teeth_mm).triangle >= 0 ||
                            bone.nearest(p, in_bone_mm).triangle >= 0 ||
                            bone.winding_number(p) > 0.5;
      cells[{static_cast<int>(std::floor(right_.dot(p) / section_mm)),
             static_cast<int>(std::floor(up_.dot(p) / section_mm))}][on_crown]
          .push_back(p);
    }
    for (auto& [cell, parts] : cells) {
      auto& [gum, inside] = parts;
      if (inside.empty()) continue;
      if (gum.size() < inside.size()) inside.insert(inside.end(), gum.begin(), gum.end());
      add_section(inside, points, rear);
    }
  }

  void add_section(const Points& inside, const Points& all, double rear) {
    CrownSection section;
    section.extent.fill(-1e9);
    section.top = -1e9;
    double own_rear = -1e9;
    for (const auto& p : inside) {
      own_rear = std::max(own_rear, p.y());
      double top = bite_.dot(p);
      for (const auto& q : all)
        if (const Vector3d off = q - p;
            off.squaredNorm() - std::pow(bite_.dot(off), 2) < top_reach_mm * top_reach_mm)
          top = std::max(top, bite_.dot(q));
      for (int k = 0; k < sides; ++k)
        section.extent[k] = std::max(section.extent[k], directions_[k].dot(p));
      section.floor += (top - crown_floor_mm) / static_cast<double>(inside.size());
      section.top = std::max(section.top, top);
    }
    if (own_rear < rear - arch_end_mm) section.tube_mm = wide_tube_mm;
    sections_.push_back(section);
  }

  /// Points at most 1 mm apart, of a triangle near the crowns.
  template <class Mark>
  void mark_triangle(const TriMesh& bone, const Eigen::Vector3i& t, const Mark& mark) const {
    const Vector3d &a = bone.vertices[t[0]], &b = bone.vertices[t[1]], &c = bone.vertices[t[2]];
    Box own;
    for (const Vector3d* p : {&a, &b, &c}) own.add(*p);
    if (!meet(own, box_)) return;
    constexpr double apart_mm = 1;
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(longest / apart_mm)));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vector3d p = a + (b - a) * i / n + (c - a) * j / n;
        if (box_.contains(p)) mark(p);
      }
  }

  bool holds(const CrownSection& section, const Vector3d& p) const {
    const double height = bite_.dot(p);
    if (height < section.floor + least_above_mm || height > section.top + ceiling_mm) return false;
    for (int k = 0; k < sides; ++k)
      if (directions_[k].dot(p) > section.extent[k] + in_bone_mm) return false;
    return true;
  }

  /// Planes round the space of a section, facing outward, moved outward.
  std::vector<Plane> planes_of(const CrownSection& section, double outward_mm) const {
    std::vector<Plane> planes = {{-bite_, outward_mm - section.floor},
                                 {bite_, section.top + ceiling_mm + outward_mm}};
    for (int k = 0; k < sides; ++k)
      planes.push_back({directions_[k], section.extent[k] + section.tube_mm + outward_mm});
    return planes;
  }

  Cut cut_of(const CrownSection& section, int number) const {
    const std::vector<Plane> planes = planes_of(section, 0);
    Region inside = opposite(Region::above(planes[0]));
    for (std::size_t i = 1; i < planes.size(); ++i)
      inside = both(std::move(inside), opposite(Region::above(planes[i])));
    return {"crowns " + std::to_string(number), std::move(inside), planes_of(section, beyond_mm)};
  }

  Box box_;  // of the scan, and round it
  Vector3d bite_, right_, up_;
  std::array<Vector3d, sides> directions_;
  std::vector<CrownSection> sections_;
};

bool has_cut_face(const Piece& piece) {
  return std::any_of(piece.wall.begin(), piece.wall.end(), [](int wall) { return wall >= 0; });
}

void append(TriMesh& mesh, const TriMesh& other) {
  const int offset = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  mesh.colors.insert(mesh.colors.end(), other.colors.begin(), other.colors.end());
  for (const auto& t : other.triangles)
    mesh.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
}

/// The pieces beside a cut, without those that it set free: small ones of a shell that has a larger
/// one.
TriMesh joined_rest(const TriMesh& before, const std::vector<Piece>& pieces) {
  const Components shells = find_components(before);
  const auto for_shells = [&](const Piece& piece, const auto& visit) {
    for (const int source : piece.source)
      if (source >= 0) visit(shells.of_triangle[static_cast<std::size_t>(source)]);
  };
  std::vector<double> largest(static_cast<std::size_t>(shells.count), 0);
  for (const Piece& piece : pieces)
    if (piece.sides.front() != CutSide::above)
      for_shells(piece, [&](int s) { largest[s] = std::max(largest[s], piece.volume_mm3); });
  TriMesh rest;
  for (const Piece& piece : pieces) {
    if (piece.sides.front() == CutSide::above) continue;
    bool set_free = false;
    if (has_cut_face(piece))
      for_shells(piece, [&](int s) {
        set_free = set_free || piece.volume_mm3 < set_free_fraction * largest[s];
      });
    if (!set_free) append(rest, piece.mesh);
  }
  return rest;
}

/// Parts a bone into its shells near a box and the others, such as far cavities.
std::array<TriMesh, 2> parted_shells(const TriMesh& bone, const Box& box) {
  const Components shells = find_components(bone);
  std::vector<char> near(static_cast<std::size_t>(shells.count), 0);
  for (std::size_t t = 0; t < bone.triangles.size(); ++t) {
    Box own;
    for (const int v : bone.triangles[t]) own.add(bone.vertices[v]);
    if (meet(own, box)) near[shells.of_triangle[t]] = 1;
  }
  std::array<TriMesh, 2> parts = {bone, bone};
  for (const bool is_near : {false, true}) {
    TriMesh& part = parts[is_near];
    part.triangles.clear();
    for (std::size_t t = 0; t < bone.triangles.size(); ++t)
      if (near[shells.of_triangle[t]] == is_near) part.triangles.push_back(bone.triangles[t]);
    drop_unreferenced(part);
  }
  return parts;
}

}  // namespace

BoneWithoutCrowns without_carried_crowns(const TriMesh& bone, const ReplacingCrowns& crowns) {
  BoneWithoutCrowns result{bone};
  if (bone.empty()) return result;
  const std::vector<Cut> cuts = CrownSpace(crowns, TriangleTree(bone)).cuts_of(bone);
  if (cuts.empty()) return result;
  result.open_edges = unbalanced_edges(bone);
  result.inside_out = signed_volume(bone) < 0;
  if (result.open_edges > 0 || result.inside_out) return result;
  auto [far, rest] = parted_shells(bone, box_round(crowns.scan));
  // One after another: together they would divide each other into many pieces.
  for (const Cut& cut : cuts) {
    if (rest.empty()) break;
    rest = joined_rest(rest, cut_bone(rest, {&cut, 1}).pieces);
  }
  append(rest, far);
  result.mesh = std::move(rest);
  result.removed_mm3 = signed_volume(bone) - signed_volume(result.mesh);
  return result;
}

}  // namespace condyle
