#include "sim/tissue/skin_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/core/error.h"
#include "engine/math/smooth_step.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/pieces.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Keeps the given triangles and the vertices they use; `source` is updated to match.
TriMesh kept_part(const TriMesh& mesh, const std::vector<char>& keep, std::vector<int>& source) {
  TriMesh out;
  std::vector<int> index(mesh.vertices.size(), -1);
  std::vector<int> from;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!keep[t]) continue;
    Eigen::Vector3i tri = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      int& i = index[tri[k]];
      if (i < 0) {
        i = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[tri[k]]);
        from.push_back(source[tri[k]]);
      }
      tri[k] = i;
    }
    out.triangles.push_back(tri);
  }
  source = std::move(from);
  return out;
}

double triangle_area(const TriMesh& mesh, const Eigen::Vector3i& t) {
  return 0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                   .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                   .norm();
}

/// Keeps only the largest piece (by area).
void keep_largest(TriMesh& mesh, std::vector<int>& source) {
  const Components parts = find_components(mesh);
  if (parts.count < 2) return;
  std::vector<double> area(parts.count, 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    area[parts.of_triangle[t]] += triangle_area(mesh, mesh.triangles[t]);
  const int largest = static_cast<int>(std::max_element(area.begin(), area.end()) - area.begin());
  std::vector<char> keep(mesh.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = parts.of_triangle[t] == largest;
  mesh = kept_part(mesh, keep, source);
}

/// Triangles use the first of all vertices at equal coordinates; no vertex is removed.
void join_equal_points(TriMesh& mesh) {
  std::vector<int> order(mesh.vertices.size()), first(mesh.vertices.size());
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = static_cast<int>(v);
  const auto key = [&](int v) {
    const Vector3d& p = mesh.vertices[v];
    return std::array<double, 3>{p.x(), p.y(), p.z()};
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  std::vector<Eigen::Vector3i> kept;
  for (auto t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) t[k] = first[t[k]];
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) kept.push_back(t);
  }
  mesh.triangles = std::move(kept);
}

/// Drops triangles until every edge has one or two of consistent orientation. Returns how many were
/// dropped.
int make_manifold(TriMesh& mesh, std::vector<int>& source) {
  std::vector<char> keep(mesh.triangles.size(), 1);
  int dropped = 0;
  const EdgeList list = find_edges(mesh);
  for (const auto& edge : list.edges) {
    int forward = 0, backward = 0;
    for (int s = edge.first; s < edge.first + edge.count; ++s) {
      const EdgeSide& side = list.sides[s];
      if (!keep[side.triangle]) continue;
      int& seen = side.forward ? forward : backward;
      if (++seen > 1) {
        keep[side.triangle] = 0;
        ++dropped;
      }
    }
  }
  if (dropped > 0) mesh = kept_part(mesh, keep, source);
  return dropped;
}

/// Gives each fan of triangles around a vertex its own vertex, so that no two fans share one.
void separate_fans(TriMesh& mesh, std::vector<int>& source) {
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) around[mesh.triangles[t][k]].push_back(static_cast<int>(t));
  const std::size_t count = mesh.vertices.size();
  for (std::size_t v = 0; v < count; ++v) {
    std::vector<int> left = around[v];
    bool first = true;
    while (!left.empty()) {
      std::vector<int> fan{left.back()};
      left.pop_back();
      for (std::size_t i = 0; i < fan.size(); ++i) {
        const auto& a = mesh.triangles[fan[i]];
        for (std::size_t j = 0; j < left.size();) {
          const auto& b = mesh.triangles[left[j]];
          int shared = 0;
          for (int k = 0; k < 3; ++k) shared += (a.array() == b[k]).any();
          if (shared >= 2) {
            fan.push_back(left[j]);
            left.erase(left.begin() + static_cast<std::ptrdiff_t>(j));
          } else {
            ++j;
          }
        }
      }
      if (!first) {
        const int twin = static_cast<int>(mesh.vertices.size());
        const Vector3d p = mesh.vertices[v];
        mesh.vertices.push_back(p);
        const int from = source[v];
        source.push_back(from);
        for (int t : fan)
          for (int k = 0; k < 3; ++k)
            if (mesh.triangles[t][k] == static_cast<int>(v)) mesh.triangles[t][k] = twin;
      }
      first = false;
    }
  }
}

/// Triangles of the lining behind the lips: from the border of the opening inward over all
/// triangles that do not face out of the mouth.
std::vector<char> find_lining(const TriMesh& mesh, const MouthOutline& opening,
                              const Anatomy& anatomy) {
  constexpr double min_facing = 0.25;
  constexpr double reach_mm = 80;  // down to the throat
  std::vector<char> lining(mesh.triangles.size(), 0);
  if (!opening.found()) return lining;
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) around[mesh.triangles[t][k]].push_back(static_cast<int>(t));
  const auto normals = vertex_normals(mesh);
  const auto faces_out = [&](int v) {
    const Vector3d& p = mesh.vertices[v];
    const Vector3d out(p.x() - anatomy.incisors.x(), p.y() - (anatomy.incisors.y() + 40), 0);
    return normals[v].dot(out.normalized()) > min_facing;
  };
  std::vector<int> front = opening.upper;
  front.insert(front.end(), opening.lower.begin(), opening.lower.end());
  front.push_back(opening.right_corner);
  front.push_back(opening.left_corner);
  std::vector<char> seen(mesh.vertices.size(), 0), inner(mesh.vertices.size(), 0);
  for (int v : front) seen[v] = 1;
  while (!front.empty()) {
    const int v = front.back();
    front.pop_back();
    if (faces_out(v)) continue;
    inner[v] = 1;
    for (int t : around[v])
      for (int k = 0; k < 3; ++k) {
        const int n = mesh.triangles[t][k];
        if (seen[n] || (mesh.vertices[n] - anatomy.incisors).norm() > reach_mm) continue;
        seen[n] = 1;
        front.push_back(n);
      }
  }
  for (std::size_t t = 0; t < lining.size(); ++t) {
    const auto& tri = mesh.triangles[t];
    lining[t] = inner[tri[0]] + inner[tri[1]] + inner[tri[2]] >= 2;
  }
  return lining;
}

/// For a displayed face whose lips separate at coincident vertices: joined vertices take the side
/// of the surface that their triangles belong to.
void tell_joined_sides(const TriMesh& face, const std::vector<char>& used,
                       std::vector<signed char>& side) {
  std::vector<int> votes(face.vertices.size(), 0);
  for (int round = 0; round < 2; ++round) {  // the second for those surrounded by joined vertices
    const auto counts = [&](int v) { return used[v] || (round > 0 && votes[v] != 0); };
    std::vector<int> more(face.vertices.size(), 0);
    for (const auto& t : face.triangles) {
      int sum = 0;
      for (int v : t) sum += counts(v) ? side[v] : 0;
      for (int v : t)
        if (!used[v] && votes[v] == 0) more[v] += sum;
    }
    for (std::size_t v = 0; v < votes.size(); ++v) {
      if (more[v] == 0) continue;
      votes[v] = more[v];
      side[v] = more[v] > 0 ? 1 : -1;
    }
  }
}

/// Joined vertices of the lining on the same side move with the same point of the skin.
void carry_joined_lining(const TriMesh& face, const std::vector<char>& used,
                         const std::vector<signed char>& side, std::vector<Vector3d>& carried_at) {
  const auto key = [&](std::size_t v) {
    const Vector3d& p = face.vertices[v];
    return std::array<double, 3>{p.x(), p.y(), p.z()};
  };
  std::map<std::array<double, 3>, std::size_t> lining;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] && carried_at[v] != face.vertices[v]) lining.emplace(key(v), v);
  if (lining.empty()) return;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (!used[v])
      if (const auto found = lining.find(key(v));
          found != lining.end() && side[found->second] * side[v] >= 0)
        carried_at[v] = carried_at[found->second];
}

/// Keeps small pieces of what is cut off: dips and bumps that the border of the region passes.
void keep_small(const TriMesh& mesh, const std::vector<char>& dropped, std::vector<char>& keep) {
  constexpr double largest_mm2 = 150;
  TriMesh off{mesh.vertices, {}, {}};
  std::vector<std::size_t> number;  // in the mesh, of each triangle cut off
  for (std::size_t t = 0; t < dropped.size(); ++t) {
    if (!dropped[t]) continue;
    off.triangles.push_back(mesh.triangles[t]);
    number.push_back(t);
  }
  const Components parts = find_components(off);
  const std::vector<double> area = component_areas(off, parts);
  for (std::size_t i = 0; i < number.size(); ++i)
    if (area[parts.of_triangle[i]] < largest_mm2) keep[number[i]] = 1;
}

/// A note where a mask ends so low that its border holds the brows.
void note_low_forehead(const TriMesh& face, const Eyes& eyes, std::vector<std::string>& notes) {
  constexpr double near_middle_mm = 20, enough_mm = 50;  // above the eyes
  const double middle = 0.5 * (eyes.left.inner + eyes.right.inner).x();
  double above = 0;
  for (const Vector3d& p : face.vertices)
    if (std::abs(p.x() - middle) < near_middle_mm) above = std::max(above, p.z() - eyes.height());
  if (above < enough_mm)
    notes.push_back("the face ends " + std::to_string(std::lround(above)) +
                    " mm above the eyes: its border holds the forehead, so that brows rise less");
}

/// Extends the region to the forehead where the eyes are known.
void reach_forehead(const TriMesh& face, const Landmarks& landmarks, SkinRegion& region,
                    std::vector<std::string>& notes) {
  constexpr double forehead_mm = 60;  // above the eyes
  region.eyes = find_eyes(face, landmarks);
  region.shape.upper_face = region.eyes.has_value();
  if (region.eyes) {
    region.shape.forehead_z = region.eyes->height() + forehead_mm;
    note_low_forehead(face, *region.eyes, notes);
  } else {
    notes.push_back(
        "the face has no openings of the eyes and no landmarks left_endocanthion, "
        "left_exocanthion, right_endocanthion and right_exocanthion: brows and forehead do not "
        "move");
  }
}

/// The triangles of the region, without the lining.
std::vector<char> triangles_inside(const TriMesh& mesh, const RegionShape& shape,
                                   const std::vector<char>& lining) {
  std::vector<char> keep(mesh.triangles.size()), beyond(mesh.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    double least = 1e9;
    for (int k = 0; k < 3; ++k)
      least = std::min(least, shape.inside(mesh.vertices[mesh.triangles[t][k]]));
    beyond[t] = least <= 0 && !lining[t];
    keep[t] = least > 0 && !lining[t];
  }
  keep_small(mesh, beyond, keep);
  return keep;
}

/// The point of the skin with which a point of the lining moves: the nearest one of its lip's edge;
/// deep in the mouth, the point itself. `to_edge_mm`: along the surface.
Vector3d carried_lining(const Vector3d& p, const Vector3d& edge, double to_edge_mm) {
  constexpr double of_lip_mm = 8, fade_mm = 12;
  return edge + smooth_step((to_edge_mm - of_lip_mm) / fade_mm) * (p - edge);
}

/// Fills `face_side` and `carried_at`: which lip each vertex belongs to, and with which point of
/// the skin it moves. `edge`: of the lips in `mesh`; `lining`: its triangles; `source`: in the face
/// part.
void join_lips(const TriMesh& mesh, const MouthOutline& edge, const std::vector<char>& lining,
               const std::vector<int>& source, SkinRegion& region) {
  std::vector<char> lines(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < lining.size(); ++t)
    if (lining[t])
      for (int v : mesh.triangles[t]) lines[v] = 1;
  const auto side = sides_of(mesh, edge, region.fissure, 30, lines).side;
  // The lining takes the side of the lip's edge where it begins. Beside a corner the outline of a
  // lip turns into the mouth: no lining begins there.
  MouthOutline margins = edge;
  for (auto* run : {&margins.upper, &margins.lower})
    std::erase_if(*run, [&](int v) { return region.fissure.at_corner(mesh.vertices[v]); });
  const LipSides lips = sides_of(mesh, margins, region.fissure, 0, lines);
  for (std::size_t v = 0; v < source.size(); ++v) {
    if (source[v] < 0) continue;
    region.face_side[source[v]] = side[v];
    region.carried_at[source[v]] = mesh.vertices[v];
    if (!lines[v] || !std::isfinite(lips.to_edge[v]) || lips.to_edge[v] == 0) continue;
    region.face_side[source[v]] = lips.side[v];
    const Vector3d& p = mesh.vertices[v];
    Vector3d at = mesh.vertices[edge.right_corner];
    const auto take_nearer = [&](int e) {
      if ((mesh.vertices[e] - p).squaredNorm() < (at - p).squaredNorm()) at = mesh.vertices[e];
    };
    take_nearer(edge.left_corner);
    for (int e : lips.side[v] > 0 ? edge.upper : edge.lower) take_nearer(e);
    region.carried_at[source[v]] = carried_lining(p, at, lips.to_edge[v]);
  }
}

}  // namespace

double RegionShape::inside(const Vector3d& p) const {
  const double height = p.z() - anatomy.condyles.z();
  // Upper border: below the eyes, or on the forehead. Posterior border: in front of the ear, below
  // the ear lobe around to the side of the neck, and above the ear across the temple.
  const double top = upper_face ? forehead_z - p.z() : 13 - height;
  const double back_limit = anatomy.condyles.y() + 3 + 72 * smooth_step((-24 - height) / 40) -
                            (upper_face ? 28 * smooth_step((height - 15) / 30) : 0);
  // This border is steep, so it is nearer than along y.
  constexpr double steepness = 0.45;
  const double back = steepness * (back_limit - p.y());
  return std::min({top, back, p.z() - floor_z});
}

SkinRegion cut_region(const TriMesh& face, const Landmarks& landmarks, const Anatomy& anatomy,
                      bool upper_face, std::vector<std::string>& notes) {
  SkinRegion region;
  TriMesh mesh{face.vertices, face.triangles, {}};
  std::vector<int> source(mesh.vertices.size());
  for (std::size_t v = 0; v < source.size(); ++v) source[v] = static_cast<int>(v);
  join_equal_points(mesh);
  if (const int dropped = make_manifold(mesh, source))
    notes.push_back(
        "face: " + std::to_string(dropped) +
        " triangles at edges shared by more than two were excluded from the soft tissue");
  keep_largest(mesh, source);
  separate_fans(mesh, source);

  MouthOutline opening = find_mouth(mesh, landmarks, anatomy.incisors);
  if (!opening.found()) {
    opening = cut_lip_line(mesh, landmarks, anatomy.incisors, notes);
    source.resize(mesh.vertices.size(), -1);
  }
  std::vector<char> on_own_border(mesh.vertices.size(), 0);
  for (const auto& loop : border_loops(mesh))
    for (int v : loop) on_own_border[v] = 1;

  region.shape.anatomy = anatomy;
  if (upper_face) reach_forehead(face, landmarks, region, notes);
  // A closed bust has a flat underside, which is no skin; far below the jaw nothing moves. A mask
  // ends above that: its own rim may move.
  const Box box = bounding_box(mesh);
  const bool mask = box.low.z() > anatomy.mandible_low - 45;
  region.shape.floor_z =
      mask ? box.low.z() - 100 : std::max(box.low.z() + 4, anatomy.mandible_low - 85);

  const auto lining = find_lining(mesh, opening, anatomy);
  const auto keep = triangles_inside(mesh, region.shape, lining);
  std::vector<int> kept_vertex(mesh.vertices.size());
  for (std::size_t v = 0; v < kept_vertex.size(); ++v) kept_vertex[v] = static_cast<int>(v);
  TriMesh part = kept_part(mesh, keep, kept_vertex);
  keep_largest(part, kept_vertex);
  separate_fans(part, kept_vertex);
  if (part.triangles.size() < 100)
    throw InputError(
        "face: no skin found around the jaw; check that face and bones are in the same "
        "position, unit and frame");

  std::vector<char> is_mouth(part.vertices.size(), 0);
  if (opening.found()) {
    region.mouth = find_mouth(part, landmarks, anatomy.incisors);
    if (!region.mouth.found())
      throw InputError(
          faces_outward(mesh)
              ? "face: the mouth lies outside the region around the jaw; check the landmarks"
              : "face: its triangles seem to be turned inside out; turn them and import it again");
    is_mouth[region.mouth.right_corner] = is_mouth[region.mouth.left_corner] = 1;
    for (int v : region.mouth.upper) is_mouth[v] = 1;
    for (int v : region.mouth.lower) is_mouth[v] = 1;
  } else {
    notes.push_back(
        "no opening between the lips was found and none could be cut: the mouth stays closed");
  }
  for (const auto& loop : border_loops(part))
    for (int v : loop) {
      if (is_mouth[v]) continue;
      (on_own_border[kept_vertex[v]] ? region.border : region.rim).push_back(v);
    }

  region.fissure = OralFissure(part, region.mouth);
  MouthOutline edge = region.mouth;
  for (auto* run : {&edge.upper, &edge.lower})
    for (int& v : *run) v = kept_vertex[v];
  for (int* corner : {&edge.right_corner, &edge.left_corner})
    if (*corner >= 0) *corner = kept_vertex[*corner];
  region.carried_at = face.vertices;
  region.face_side.assign(face.vertices.size(), 0);
  join_lips(mesh, edge, lining, source, region);
  std::vector<char> used(face.vertices.size(), 0);
  for (const auto& t : mesh.triangles)
    for (int v : t)
      if (source[v] >= 0) used[source[v]] = 1;
  tell_joined_sides(face, used, region.face_side);
  carry_joined_lining(face, used, region.face_side, region.carried_at);
  region.mesh = std::move(part);
  return region;
}

}  // namespace condyle
