#include "engine/mesh/topology.h"

#include <algorithm>

#include "engine/core/disjoint_sets.h"

namespace condyle {
namespace {

std::vector<BoundaryLoop> boundary_loops(const TriMesh& mesh, const EdgeList& list) {
  DisjointSets sets(mesh.vertices.size());
  for (const auto& edge : list.edges)
    if (edge.count == 1) sets.join(edge.low, edge.high);
  std::vector<int> loop_of(mesh.vertices.size(), -1);
  std::vector<BoundaryLoop> loops;
  for (const auto& edge : list.edges) {
    if (edge.count != 1) continue;
    int& index = loop_of[sets.find(edge.low)];
    if (index < 0) {
      index = static_cast<int>(loops.size());
      loops.emplace_back();
    }
    auto& loop = loops[index];
    const auto &a = mesh.vertices[edge.low], &b = mesh.vertices[edge.high];
    ++loop.edges;
    loop.length_mm += (b - a).norm();
    loop.box.add(a);
    loop.box.add(b);
  }
  std::stable_sort(loops.begin(), loops.end(),
                   [](const auto& a, const auto& b) { return a.length_mm > b.length_mm; });
  return loops;
}

}  // namespace

EdgeList find_edges(const TriMesh& mesh) {
  struct Half {
    int low, high, triangle;
    bool forward;
  };
  std::vector<Half> halves;
  halves.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), static_cast<int>(i), a < b});
    }
  }
  // By counting, first on the lower vertex: far cheaper than a comparison sort of everything.
  std::vector<int> start(mesh.vertices.size() + 1, 0);
  for (const auto& h : halves) ++start[h.low + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Half> sorted(halves.size());
  {
    std::vector<int> next(start.begin(), start.end() - 1);
    for (const auto& h : halves) sorted[next[h.low]++] = h;
  }
  EdgeList list;
  list.edges.reserve(halves.size() / 2);
  list.sides.reserve(halves.size());
  for (std::size_t v = 0; v + 1 < start.size(); ++v) {
    std::sort(sorted.begin() + start[v], sorted.begin() + start[v + 1],
              [](const Half& a, const Half& b) {
                return std::pair(a.high, a.triangle) < std::pair(b.high, b.triangle);
              });
    for (int i = start[v]; i < start[v + 1]; ++i) {
      const auto& h = sorted[i];
      if (list.edges.empty() || list.edges.back().low != h.low || list.edges.back().high != h.high)
        list.edges.push_back({h.low, h.high, static_cast<int>(list.sides.size()), 0});
      ++list.edges.back().count;
      list.sides.push_back({h.triangle, h.forward});
    }
  }
  return list;
}

Components find_components(const TriMesh& mesh) {
  DisjointSets sets(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  Components result;
  std::vector<int> number(mesh.vertices.size(), -1);
  result.of_triangle.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    int& n = number[sets.find(t[0])];
    if (n < 0) n = result.count++;
    result.of_triangle.push_back(n);
  }
  return result;
}

Topology inspect(const TriMesh& mesh) {
  Topology report;
  report.components = find_components(mesh).count;
  report.volume_mm3 = signed_volume(mesh);
  const EdgeList list = find_edges(mesh);
  for (const auto& edge : list.edges) {
    if (edge.count == 1) ++report.boundary_edges;
    if (edge.count == 2 && list.sides[edge.first].forward == list.sides[edge.first + 1].forward)
      ++report.misoriented_edges;
    if (edge.count > 2) {
      ++report.nonmanifold_edges;
      report.nonmanifold_box.add(mesh.vertices[edge.low]);
      report.nonmanifold_box.add(mesh.vertices[edge.high]);
    }
  }
  report.boundary = boundary_loops(mesh, list);
  return report;
}

}  // namespace condyle
