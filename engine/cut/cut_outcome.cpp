#include "engine/cut/cut_outcome.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace condyle {
namespace {

bool in_reach(CellSide side) { return side != CellSide::outside; }

/// Whether a face in the bone is on the boundary of a cut's reach.
bool ends_reach(const CellSides& sides, const CellFace& face, int cut) {
  return face.front >= 0 && face.back >= 0 &&
         in_reach(sides.of(face.front, cut)) != in_reach(sides.of(face.back, cut));
}

double area(const CellComplex& complex, const CellFace& face) {
  const auto& p = complex.vertices();
  const auto& v = face.vertices;
  return 0.5 * (p[v[1]] - p[v[0]]).cross(p[v[2]] - p[v[0]]).norm();
}

/// Vertices at which the walls of a cut end within the bone.
std::vector<int> end_vertices(const CellComplex& complex, const CellSides& sides, int cut) {
  std::vector<char> on_wall(complex.vertices().size(), false), on_end(on_wall);
  for (const CellFace& face : complex.faces()) {
    const bool wall = is_wall_of(sides, face, cut), end = ends_reach(sides, face, cut);
    if (!wall && !end) continue;
    for (const int v : face.vertices) (wall ? on_wall : on_end)[v] = true;
  }
  std::vector<int> ends;
  for (std::size_t v = 0; v < on_wall.size(); ++v)
    if (on_wall[v] && on_end[v]) ends.push_back(static_cast<int>(v));
  return ends;
}

/// Distance along a ray to where it leaves the bone; 0 if it does not.
double exit_distance(const TriMesh& bone, const Eigen::Vector3d& from,
                     const Eigen::Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& t : bone.triangles) {
    const Eigen::Vector3d &a = bone.vertices[t[0]], u = bone.vertices[t[1]] - a,
                          v = bone.vertices[t[2]] - a;
    const Eigen::Vector3d cross = direction.cross(v);
    const double determinant = u.dot(cross);
    if (determinant >= 0) continue;  // entered, or parallel
    const Eigen::Vector3d offset = from - a;
    const double s = offset.dot(cross) / determinant;
    if (s < 0 || s > 1) continue;
    const Eigen::Vector3d second = offset.cross(u);
    const double r = direction.dot(second) / determinant;
    if (r < 0 || s + r > 1) continue;
    const double distance = v.dot(second) / determinant;
    if (distance > 1e-6) nearest = std::min(nearest, distance);
  }
  return std::isfinite(nearest) ? nearest : 0;
}

/// The wall's normal at each vertex of a cut; zero elsewhere.
std::vector<Eigen::Vector3d> wall_normals(const CellComplex& complex, const CellSides& sides,
                                          int cut) {
  const auto& p = complex.vertices();
  std::vector<Eigen::Vector3d> normals(p.size(), Eigen::Vector3d::Zero());
  for (const CellFace& face : complex.faces()) {
    if (!is_wall_of(sides, face, cut)) continue;
    const auto& v = face.vertices;
    const Eigen::Vector3d normal = (p[v[1]] - p[v[0]]).cross(p[v[2]] - p[v[0]]);
    for (const int k : v) normals[k] += normal;
  }
  return normals;
}

/// The bone that a cut which does not go through leaves: the longest exit from the bone at its
/// end, along its surface.
void measure_left(const CellComplex& complex, const CellSides& sides, int cut, const TriMesh& bone,
                  const std::vector<Plane>& reach, CutOutcome& outcome) {
  const std::vector<int> ends = end_vertices(complex, sides, cut);
  const auto normals = wall_normals(complex, sides, cut);
  constexpr std::size_t samples = 24;
  const std::size_t step = std::max<std::size_t>(1, ends.size() / samples);
  for (std::size_t i = 0; i < ends.size(); i += step) {
    const Eigen::Vector3d& at = complex.vertices()[ends[i]];
    for (const Plane& plane : reach) {
      if (std::abs(plane.distance(at)) > 1e-6) continue;
      const Eigen::Vector3d normal = normals[ends[i]].normalized();
      Eigen::Vector3d out = plane.normal - plane.normal.dot(normal) * normal;
      if (out.norm() < 1e-6) continue;
      out.normalize();
      const double distance = exit_distance(bone, at, out);
      if (distance <= outcome.left_mm) continue;
      outcome.left_mm = distance;
      outcome.left_at = at + 0.5 * distance * out;
    }
  }
}

}  // namespace

bool is_wall_of(const CellSides& sides, const CellFace& face, int cut) {
  if (face.front < 0 || face.back < 0) return false;
  const CellSide front = sides.of(face.front, cut), back = sides.of(face.back, cut);
  return in_reach(front) && in_reach(back) && front != back;
}

PartSides find_part_sides(const CellComplex& complex, const CellSides& sides,
                          const JoinedCells& joined) {
  std::vector<std::vector<std::array<char, 2>>> seen(
      joined.parts, std::vector<std::array<char, 2>>(sides.cuts, {false, false}));
  for (std::size_t i = 0; i < complex.faces().size(); ++i)
    for (const bool behind : {false, true}) {
      const int part = joined.of_face[i][behind];
      if (part < 0) continue;
      const int cell = behind ? complex.faces()[i].back : complex.faces()[i].front;
      for (int cut = 0; cut < sides.cuts; ++cut)
        if (in_reach(sides.of(cell, cut)))
          seen[part][cut][sides.of(cell, cut) == CellSide::below] = true;
    }
  PartSides parts{{}, std::vector<char>(sides.cuts, false)};
  for (const auto& of_cuts : seen) {
    auto& row = parts.sides.emplace_back();
    for (int cut = 0; cut < sides.cuts; ++cut) {
      const auto [above, below] = of_cuts[cut];
      if (above && below) parts.joins_both[cut] = true;
      row.push_back(above == below ? CutSide::neither : above ? CutSide::above : CutSide::below);
    }
  }
  return parts;
}

std::vector<CutOutcome> find_outcomes(const CellComplex& complex, const CellSides& sides,
                                      const JoinedCells& joined, const PartSides& parts,
                                      const TriMesh& bone, std::span<const Cut> cuts) {
  std::vector<CutOutcome> outcomes(cuts.size());
  for (int cut = 0; cut < sides.cuts; ++cut) {
    CutOutcome& outcome = outcomes[cut];
    for (std::size_t i = 0; i < complex.faces().size(); ++i) {
      const CellFace& face = complex.faces()[i];
      const auto [front, back] = joined.of_face[i];
      const bool kerf_at_surface =
          face.front < 0 && face.back >= 0 && sides.of(face.back, cut) == CellSide::kerf;
      outcome.meets_bone |= kerf_at_surface;
      if (!is_wall_of(sides, face, cut)) continue;
      outcome.meets_bone = true;
      outcome.wall_area_mm2 += area(complex, face) * ((front >= 0) + (back >= 0));
    }
    outcome.through = outcome.meets_bone && !parts.joins_both[cut];
    outcome.open_on_purpose = outcome.meets_bone && !outcome.through && cuts[cut].ends_in_bone;
    if (outcome.meets_bone && !outcome.through)
      measure_left(complex, sides, cut, bone, cuts[cut].reach, outcome);
    if (cuts[cut].stays_in_bone) outcome.windows = find_windows(complex, sides, cut);
  }
  return outcomes;
}

}  // namespace condyle
