#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

#include "engine/core/disjoint_sets.h"
#include "engine/cut/cap_loops.h"
#include "engine/cut/cut_outcome.h"

namespace condyle {
namespace {

struct Rim {
  std::vector<int> vertices;
  double area_mm2 = 0;
};

/// Joins directed edges end to end.
std::vector<Rim> join_rims(const std::vector<std::pair<int, int>>& edges,
                           const std::vector<Eigen::Vector3d>& p) {
  std::multimap<int, int> next;
  for (const auto& [from, to] : edges) next.emplace(from, to);
  std::vector<Rim> rims;
  while (!next.empty()) {
    Rim rim;
    auto step = next.begin();
    while (step != next.end()) {
      rim.vertices.push_back(step->first);
      const int to = step->second;
      next.erase(step);
      step = next.find(to);
    }
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    const Eigen::Vector3d& base = p[rim.vertices[0]];
    for (std::size_t i = 0; i < rim.vertices.size(); ++i)
      area +=
          0.5 *
          (p[rim.vertices[i]] - base).cross(p[rim.vertices[(i + 1) % rim.vertices.size()]] - base);
    rim.area_mm2 = area.norm();
    rims.push_back(std::move(rim));
  }
  return rims;
}

/// The walls on one side of a cut, which are connected surfaces: every rim of one but the longest
/// around it is that of a hole.
std::vector<CutWindow> holes_on(CellSide side, const CellComplex& complex, const CellSides& sides,
                                int cut) {
  DisjointSets surfaces(complex.vertices().size());
  CapEdges edges;
  for (const CellFace& face : complex.faces()) {
    if (!is_wall_of(sides, face, cut)) continue;
    const bool in_front = sides.of(face.front, cut) == side;
    if (!in_front && sides.of(face.back, cut) != side) continue;
    const auto& v = face.vertices;
    for (int k = 0; k < 3; ++k) {
      const int a = v[k], b = v[(k + 1) % 3];
      surfaces.join(a, b);
      in_front ? edges.add(b, a) : edges.add(a, b);
    }
  }
  std::map<int, std::vector<Rim>> rims;  // by surface
  for (Rim& rim : join_rims(edges.remaining(), complex.vertices()))
    rims[surfaces.find(rim.vertices[0])].push_back(std::move(rim));
  std::vector<CutWindow> holes;
  for (auto& [surface, around] : rims) {
    const auto outer =
        std::max_element(around.begin(), around.end(),
                         [](const Rim& a, const Rim& b) { return a.area_mm2 < b.area_mm2; });
    for (auto rim = around.begin(); rim != around.end(); ++rim) {
      if (rim == outer || rim->area_mm2 < window_mm2) continue;
      CutWindow hole{rim->area_mm2, Eigen::Vector3d::Zero()};
      for (const int v : rim->vertices)
        hole.at += complex.vertices()[v] / static_cast<double>(rim->vertices.size());
      holes.push_back(hole);
    }
  }
  std::stable_sort(holes.begin(), holes.end(),
                   [](const CutWindow& a, const CutWindow& b) { return a.area_mm2 > b.area_mm2; });
  return holes;
}

double total_area(const std::vector<CutWindow>& windows) {
  double sum = 0;
  for (const CutWindow& window : windows) sum += window.area_mm2;
  return sum;
}

}  // namespace

std::vector<CutWindow> find_windows(const CellComplex& complex, const CellSides& sides, int cut) {
  // A kerf has two walls; the one nearer to the surface has the larger holes.
  auto above = holes_on(CellSide::above, complex, sides, cut),
       below = holes_on(CellSide::below, complex, sides, cut);
  return total_area(above) >= total_area(below) ? above : below;
}

}  // namespace condyle
