#include <algorithm>
#include <array>
#include <map>

#include "engine/cut/cut_outcome.h"

namespace condyle {
namespace {

using CutPair = std::pair<int, int>;

/// Where two cuts meet.
struct Meeting {
  std::array<bool, 4> quadrants{};  // sides of both that lie around the vertices of their walls
  double overlap_mm3 = 0;           // of both kerfs
  double ends_mm2 = 0;              // of the overlap's boundary at which one of the cuts ends
};
using Meetings = std::map<CutPair, Meeting>;

/// The sides of two cuts around each vertex at which their walls meet.
void find_quadrants(const CellComplex& complex, const CellSides& sides, Meetings& meetings) {
  std::vector<std::vector<int>> walls(complex.vertices().size());  // cuts, by vertex
  for (const CellFace& face : complex.faces())
    for (int cut = 0; cut < sides.cuts; ++cut) {
      if (!is_wall_of(sides, face, cut)) continue;
      for (const int v : face.vertices)
        if (std::find(walls[v].begin(), walls[v].end(), cut) == walls[v].end())
          walls[v].push_back(cut);
    }
  const auto add = [&](int cell, int a, int b) {
    const CellSide first = sides.of(cell, a), second = sides.of(cell, b);
    for (const CellSide side : {first, second})
      if (side != CellSide::above && side != CellSide::below) return;
    meetings[{a, b}].quadrants[2 * (first == CellSide::above) + (second == CellSide::above)] = true;
  };
  for (const CellFace& face : complex.faces())
    for (const int v : face.vertices)
      for (const int a : walls[v])
        for (const int b : walls[v])
          for (const int cell : {face.front, face.back})
            if (a < b && cell >= 0) add(cell, a, b);
}

std::vector<int> kerfs_of(const CellSides& sides, int cell) {
  std::vector<int> cuts;
  for (int cut = 0; cell >= 0 && cut < sides.cuts; ++cut)
    if (sides.of(cell, cut) == CellSide::kerf) cuts.push_back(cut);
  return cuts;
}

/// The bone that two saws remove both, and where one of them ends in the other's kerf.
void measure_overlaps(const CellComplex& complex, const CellSides& sides, Meetings& meetings) {
  std::vector<std::vector<int>> kerfs(complex.cells());
  for (int cell = 0; cell < complex.cells(); ++cell) kerfs[cell] = kerfs_of(sides, cell);
  const auto& p = complex.vertices();
  for (const CellFace& face : complex.faces())
    for (const bool behind : {false, true}) {
      const int cell = behind ? face.back : face.front, other = behind ? face.front : face.back;
      if (cell < 0 || kerfs[cell].size() < 2) continue;
      const Eigen::Vector3d a = p[face.vertices[0]] - p[0], b = p[face.vertices[1]] - p[0],
                            c = p[face.vertices[2]] - p[0];
      const Eigen::Vector3d area = 0.5 * (b - a).cross(c - a);
      for (const int first : kerfs[cell])
        for (const int second : kerfs[cell]) {
          if (first >= second) continue;
          Meeting& meeting = meetings[{first, second}];
          meeting.overlap_mm3 += (behind ? 1 : -1) * a.dot(area) / 3;
          if (other >= 0 && (sides.of(other, first) == CellSide::outside ||
                             sides.of(other, second) == CellSide::outside))
            meeting.ends_mm2 += area.norm();
        }
    }
}

}  // namespace

std::vector<CutPair> find_crossings(const CellComplex& complex, const CellSides& sides,
                                    std::span<const Cut> cuts) {
  Meetings meetings;
  find_quadrants(complex, sides, meetings);
  measure_overlaps(complex, sides, meetings);
  std::vector<CutPair> crossings;
  for (const auto& [pair, meeting] : meetings) {
    const bool cross = std::all_of(meeting.quadrants.begin(), meeting.quadrants.end(),
                                   [](bool present) { return present; });
    // An oblique end reaches farther into the other's kerf than a straight one.
    const double deepest = 2 * std::max(cuts[pair.first].kerf_mm, cuts[pair.second].kerf_mm);
    if (cross || meeting.overlap_mm3 > deepest * meeting.ends_mm2) crossings.push_back(pair);
  }
  return crossings;
}

}  // namespace condyle
