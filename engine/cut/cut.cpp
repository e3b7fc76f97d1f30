#include "engine/cut/cut.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "engine/cut/cell_complex.h"
#include "engine/cut/cell_sides.h"
#include "engine/cut/cut_outcome.h"
#include "engine/cut/join_cells.h"
#include "engine/cut/part_faces.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

constexpr double max_kerf_mm = 2, min_kerf_mm = 1e-3;

void check_plane(const std::string& cut, const Plane& plane) {
  if (!plane.normal.allFinite() || !std::isfinite(plane.offset_mm) ||
      std::abs(plane.normal.norm() - 1) > 1e-9)
    throw InputError(fmt::format("cut \"{}\": a plane has no finite unit normal and offset", cut));
}

void check(const TriMesh& bone, std::span<const Cut> cuts) {
  if (const int edges = unbalanced_edges(bone); edges > 0)
    throw InputError(
        fmt::format("the bone cannot be cut: its surface is open or turned at {} edges; close it "
                    "first",
                    edges));
  for (const Cut& cut : cuts) {
    if (!(cut.kerf_mm == 0 || (cut.kerf_mm >= min_kerf_mm && cut.kerf_mm <= max_kerf_mm)))
      throw InputError(fmt::format("cut \"{}\": a kerf of {} mm; 0, or {} to {} mm", cut.name,
                                   cut.kerf_mm, min_kerf_mm, max_kerf_mm));
    for (const Plane& plane : cut.reach) check_plane(cut.name, plane);
    for (const auto& leaf : cut.above.leaves()) check_plane(cut.name, leaf.plane);
  }
}

/// Positions and colours of all vertices that pieces use.
struct Vertices {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3f> colors;  // empty without
};

Vertices all_vertices(const CellComplex& complex, const TriMesh& bone) {
  Vertices all{complex.vertices(), bone.colors};
  if (all.colors.empty()) return all;
  for (const auto& [low, high, fraction] : complex.edge_points())
    all.colors.push_back(all.colors[low] +
                         static_cast<float>(fraction) * (all.colors[high] - all.colors[low]));
  return all;
}

Piece make_piece(std::vector<PartFace> faces, Vertices& all, std::vector<int>& number) {
  std::vector<VertexCopy> copies;
  part_touching_sheets(faces, all.points, copies);
  if (!all.colors.empty())
    for (const auto& [low, high] : copies)
      all.colors.push_back(0.5F * (all.colors[low] + all.colors[high]));
  number.resize(all.points.size(), -1);
  Piece piece;
  std::vector<int> used;
  for (const PartFace& face : faces) {
    Eigen::Vector3i triangle;
    for (int k = 0; k < 3; ++k) {
      int& n = number[face.vertices[k]];
      if (n < 0) {
        n = static_cast<int>(used.size());
        used.push_back(face.vertices[k]);
      }
      triangle[k] = n;
    }
    piece.mesh.triangles.push_back(triangle);
    piece.source.push_back(face.source);
    piece.wall.push_back(face.source >= 0 ? -1 : face.wall);
  }
  for (const int v : used) {
    piece.mesh.vertices.push_back(all.points[v]);
    if (!all.colors.empty()) piece.mesh.colors.push_back(all.colors[v]);
    number[v] = -1;
  }
  piece.volume_mm3 = signed_volume(piece.mesh);
  return piece;
}

void append(Piece& piece, const Piece& cavity) {
  const int offset = static_cast<int>(piece.mesh.vertices.size());
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(piece.mesh.vertices, cavity.mesh.vertices);
  add(piece.mesh.colors, cavity.mesh.colors);
  for (const auto& t : cavity.mesh.triangles) piece.mesh.triangles.push_back(t.array() + offset);
  add(piece.source, cavity.source);
  add(piece.wall, cavity.wall);
  piece.volume_mm3 += cavity.volume_mm3;
}

/// Gives each cavity to the smallest piece around it.
void place_cavities(std::vector<Piece>& pieces) {
  for (const Piece& cavity : pieces) {
    if (cavity.volume_mm3 >= 0) continue;
    Piece* around = nullptr;
    for (Piece& piece : pieces)
      if (piece.volume_mm3 > -cavity.volume_mm3 &&
          (!around || piece.volume_mm3 < around->volume_mm3) &&
          TriangleTree(piece.mesh).winding_number(cavity.mesh.vertices[0]) > 0.5)
        around = &piece;
    if (around) append(*around, cavity);
  }
  std::erase_if(pieces, [](const Piece& piece) { return piece.volume_mm3 <= 0; });
}

double kerf_volume(const CellComplex& complex, const CellSides& sides) {
  const auto& p = complex.vertices();
  double six_volumes = 0;
  for (const CellFace& face : complex.faces()) {
    const auto& v = face.vertices;
    const double part =
        (p[v[0]] - p[0]).dot((p[v[1]] - p[0]).cross(Eigen::Vector3d(p[v[2]] - p[0])));
    if (face.back >= 0 && sides.is_kerf(face.back)) six_volumes += part;
    if (face.front >= 0 && sides.is_kerf(face.front)) six_volumes -= part;
  }
  return six_volumes / 6;
}

}  // namespace

CutResult cut_bone(const TriMesh& bone, std::span<const Cut> cuts) {
  check(bone, cuts);
  CutResult result;
  if (bone.triangles.empty()) {
    result.outcomes.resize(cuts.size());
    return result;
  }
  CellComplex complex(bone);
  const CellSides sides = divide_cells(complex, cuts);
  const JoinedCells joined = join_cells(complex, sides);
  const PartSides part_sides = find_part_sides(complex, sides, joined);
  result.outcomes = find_outcomes(complex, sides, joined, part_sides, bone, cuts);
  result.crossings = find_crossings(complex, sides, cuts);
  result.kerf_volume_mm3 = kerf_volume(complex, sides);
  result.turned = complex.turned();

  Vertices all = all_vertices(complex, bone);
  std::vector<int> number;
  auto faces = part_faces(complex, joined, bone);
  for (int part = 0; part < joined.parts; ++part) {
    if (faces[part].empty()) continue;
    result.pieces.push_back(make_piece(std::move(faces[part]), all, number));
    result.pieces.back().sides = part_sides.sides[part];
  }
  place_cavities(result.pieces);
  std::stable_sort(result.pieces.begin(), result.pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.volume_mm3 > b.volume_mm3; });
  return result;
}

}  // namespace condyle
