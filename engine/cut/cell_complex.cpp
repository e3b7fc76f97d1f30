#include "engine/cut/cell_complex.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <utility>

#include "engine/cut/cap_loops.h"
#include "engine/cut/edge_key.h"
#include "engine/cut/fill_loops.h"
#include "engine/mesh/topology.h"

namespace condyle {

namespace {

/// Side of a part of a face in the division of one cell.
enum class Position : signed char { untouched, upper, lower, in_plane_up, in_plane_down };

/// The side on which the cell before (front) or behind a face is.
bool is_upper(Position position, bool behind) {
  switch (position) {
    case Position::in_plane_up:
      return !behind;
    case Position::in_plane_down:
      return behind;
    default:
      return position == Position::upper;
  }
}

}  // namespace

struct CellComplex::Division {
  const Plane& plane;
  std::span<const char> active;
  std::vector<signed char> signs;                  // by vertex: -1, 0, 1; unset: 2
  std::vector<char> at_middle;                     // by vertex: an edge at it gets a middle
  std::unordered_map<std::uint64_t, int> middles;  // vertex on a divided edge
  std::vector<CellFace> faces;
  std::vector<Position> positions;

  bool is_active(int cell) const { return cell >= 0 && active[cell]; }
  bool touches(const CellFace& face) const { return is_active(face.front) || is_active(face.back); }
  void add(CellFace face, int a, int b, int c, Position position) {
    face.vertices = {a, b, c};
    faces.push_back(face);
    positions.push_back(position);
  }
};

CellComplex::CellComplex(const TriMesh& mesh) : vertices_(mesh.vertices) {
  faces_.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    faces_.push_back({{t[0], t[1], t[2]}, -1, 0, static_cast<int>(i), -1});
  }
}

std::vector<CellComplex::Split> CellComplex::split(const Plane& plane, int wall,
                                                   std::span<const char> active) {
  assert(static_cast<int>(active.size()) == cells_);
  if (std::none_of(active.begin(), active.end(), [](char on) { return on; }))
    return std::vector<Split>(cells_);
  Division division{plane, active, {}, {}, {}, {}, {}};
  find_signs(division);
  divide_edges(division);
  divide_faces(division);
  std::vector<Split> splits = assign_cells(division);
  faces_.swap(division.faces);
  close_cells(division, splits, wall);
  return splits;
}

void CellComplex::find_signs(Division& division) const {
  constexpr double on_plane_mm = 1e-7;
  division.signs.assign(vertices_.size(), 2);
  for (const CellFace& face : faces_) {
    if (!division.touches(face)) continue;
    for (const int v : face.vertices) {
      if (division.signs[v] != 2) continue;
      const double distance = division.plane.distance(vertices_[v]);
      division.signs[v] = distance > on_plane_mm ? 1 : distance < -on_plane_mm ? -1 : 0;
    }
  }
}

void CellComplex::divide_edges(Division& division) {
  division.at_middle.assign(vertices_.size(), false);
  for (const CellFace& face : faces_) {
    if (!division.touches(face)) continue;
    for (int k = 0; k < 3; ++k) {
      int a = face.vertices[k], b = face.vertices[(k + 1) % 3];
      if (division.signs[a] * division.signs[b] != -1) continue;
      if (a > b) std::swap(a, b);
      const auto [at, is_new] =
          division.middles.try_emplace(edge_key(a, b), static_cast<int>(vertices_.size()));
      if (!is_new) continue;
      const double from = division.plane.distance(vertices_[a]),
                   to = division.plane.distance(vertices_[b]), fraction = from / (from - to);
      const Eigen::Vector3d low = vertices_[a], step = vertices_[b] - low;
      vertices_.push_back(low + fraction * step);
      edge_points_.push_back({a, b, fraction});
      division.signs.push_back(0);
      division.at_middle[a] = division.at_middle[b] = true;
    }
  }
  division.at_middle.resize(vertices_.size(), false);
}

void CellComplex::divide_faces(Division& division) {
  division.faces.reserve(faces_.size() + 8 * division.middles.size());
  division.positions.reserve(division.faces.capacity());
  const auto& signs = division.signs;
  for (const CellFace& face : faces_) {
    const auto& v = face.vertices;
    std::array<int, 3> middles{-1, -1, -1};
    int divided = 0;
    if (division.at_middle[v[0]] + division.at_middle[v[1]] + division.at_middle[v[2]] >= 2)
      for (int k = 0; k < 3; ++k) {
        const auto at = division.middles.find(edge_key(v[k], v[(k + 1) % 3]));
        if (at == division.middles.end()) continue;
        middles[k] = at->second;
        ++divided;
      }
    const auto keep = [&](Position position) {
      division.faces.push_back(face);
      division.positions.push_back(position);
    };
    if (!division.touches(face)) {
      if (divided)
        divide_crossed(division, face, middles);
      else
        keep(Position::untouched);
      continue;
    }
    const int low = std::min({signs[v[0]], signs[v[1]], signs[v[2]]}),
              high = std::max({signs[v[0]], signs[v[1]], signs[v[2]]});
    if (low == 0 && high == 0) {
      const Eigen::Vector3d normal =
          (vertices_[v[1]] - vertices_[v[0]]).cross(vertices_[v[2]] - vertices_[v[0]]);
      keep(normal.dot(division.plane.normal) >= 0 ? Position::in_plane_up
                                                  : Position::in_plane_down);
    } else if (low >= 0) {
      keep(Position::upper);
    } else if (high <= 0) {
      keep(Position::lower);
    } else {
      for (const bool upper : {true, false}) {
        std::array<int, 4> corners;
        int count = 0;
        for (int k = 0; k < 3; ++k) {
          if (upper ? signs[v[k]] >= 0 : signs[v[k]] <= 0) corners[count++] = v[k];
          if (middles[k] >= 0) corners[count++] = middles[k];
        }
        const Position position = upper ? Position::upper : Position::lower;
        const auto& [a, b, c, d] = corners;
        if (count == 3) {
          division.add(face, a, b, c, position);
        } else if ((vertices_[a] - vertices_[c]).squaredNorm() <=
                   (vertices_[b] - vertices_[d]).squaredNorm()) {
          division.add(face, a, b, c, position);
          division.add(face, a, c, d, position);
        } else {
          division.add(face, b, c, d, position);
          division.add(face, b, d, a, position);
        }
      }
    }
  }
}

/// A face between cells that are not divided, with middles on some of its edges.
void CellComplex::divide_crossed(Division& division, const CellFace& face,
                                 std::span<const int, 3> middles) {
  const auto& v = face.vertices;
  const auto add = [&](int a, int b, int c) { division.add(face, a, b, c, Position::untouched); };
  const int divided = (middles[0] >= 0) + (middles[1] >= 0) + (middles[2] >= 0);
  if (divided == 3) {
    add(v[0], middles[0], middles[2]);
    add(middles[0], v[1], middles[1]);
    add(middles[2], middles[1], v[2]);
    add(middles[0], middles[1], middles[2]);
    return;
  }
  // The first of the divided edges that follow each other.
  int k = 0;
  if (divided == 1)
    while (middles[k] < 0) ++k;
  else
    while (middles[(k + 2) % 3] >= 0) ++k;
  const int a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
  if (divided == 1) {
    add(a, middles[k], c);
    add(middles[k], b, c);
  } else {
    const int second = middles[(k + 1) % 3];
    add(middles[k], b, second);
    add(a, middles[k], second);
    add(a, second, c);
  }
}

std::vector<CellComplex::Split> CellComplex::assign_cells(Division& division) {
  const int before = cells_;
  std::vector<char> has_upper(before, false), has_lower(before, false);
  for (std::size_t i = 0; i < division.faces.size(); ++i)
    for (const bool behind : {false, true}) {
      const int cell = behind ? division.faces[i].back : division.faces[i].front;
      if (!division.is_active(cell)) continue;
      (is_upper(division.positions[i], behind) ? has_upper : has_lower)[cell] = true;
    }
  std::vector<Split> splits(before);
  for (int cell = 0; cell < before; ++cell) {
    if (!division.active[cell]) continue;
    splits[cell].side = has_upper[cell] ? Region::Side::upper : Region::Side::lower;
    if (has_upper[cell] && has_lower[cell]) splits[cell].lower = cells_++;
  }
  return splits;
}

void CellComplex::close_cells(const Division& division, const std::vector<Split>& splits,
                              int wall) {
  const int before = static_cast<int>(splits.size());
  // Edges of the upper parts in the plane, in the sense in which their faces traverse them.
  std::vector<CapEdges> rims(before);
  for (std::size_t i = 0; i < division.positions.size(); ++i)
    for (const bool behind : {false, true}) {
      int& cell = behind ? faces_[i].back : faces_[i].front;
      if (cell < 0 || cell >= before || splits[cell].lower < 0) continue;
      if (!is_upper(division.positions[i], behind)) {
        cell = splits[cell].lower;
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        int a = faces_[i].vertices[k], b = faces_[i].vertices[(k + 1) % 3];
        if (division.signs[a] != 0 || division.signs[b] != 0) continue;
        if (!behind) std::swap(a, b);
        rims[cell].add(a, b);
      }
    }
  const Eigen::Vector3d right = division.plane.normal.unitOrthogonal(),
                        up = division.plane.normal.cross(right);
  for (int cell = 0; cell < before; ++cell) {
    if (splits[cell].lower < 0) continue;
    const CapLoops cap = find_cap_loops(rims[cell], vertices_, right, up);
    const LoopFill fill = fill_loops(cap.points, cap.loops);
    turned_ += fill.turned;
    for (const auto& t : fill.triangles)
      faces_.push_back({{cap.vertices[t[0]], cap.vertices[t[1]], cap.vertices[t[2]]},
                        cell,
                        splits[cell].lower,
                        -1,
                        wall});
  }
}

int unbalanced_edges(const TriMesh& mesh) {
  const EdgeList list = find_edges(mesh);
  int count = 0;
  for (const Edge& edge : list.edges) {
    int balance = 0;
    for (int i = edge.first; i < edge.first + edge.count; ++i)
      balance += list.sides[i].forward ? 1 : -1;
    count += balance != 0;
  }
  return count;
}

}  // namespace condyle
