#include "engine/field/mesh_facts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace condyle {
namespace {

/// Piece number of each vertex: the smallest vertex it is connected with.
std::vector<int> pieces_of(const TriMesh& mesh) {
  std::vector<int> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[static_cast<std::size_t>(v)] != v) {
      int& up = parent[static_cast<std::size_t>(v)];
      up = parent[static_cast<std::size_t>(up)];
      v = up;
    }
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 2; ++i) {
      const int a = root(t[i]), b = root(t[i + 1]);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = root(static_cast<int>(v));
  return parent;
}

struct HalfEdge {
  int low, high, triangle;
  bool forward;
};

}  // namespace

MeshFacts mesh_facts(const TriMesh& mesh) {
  MeshFacts facts;
  std::vector<HalfEdge> edges;
  std::vector<int> corners(mesh.vertices.size(), 0), links(mesh.vertices.size(), 0);
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& t = mesh.triangles[n];
    const auto p = [&](int i) -> const Eigen::Vector3d& {
      return mesh.vertices[static_cast<std::size_t>(t[i])];
    };
    const Eigen::Vector3d cross = (p(1) - p(0)).cross(p(2) - p(0));
    facts.bad_triangles += t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || cross.norm() < 2e-8;
    facts.volume += p(0).dot(p(1).cross(p(2))) / 6;
    for (int i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(n), a < b});
      ++corners[static_cast<std::size_t>(a)];
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  // Around a vertex of one fan, triangles are linked by as many shared edges as there are
  // triangles (closed fan) or one fewer (open fan).
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i;
    while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high) ++j;
    if (j - i == 1) ++facts.open_edges;
    if (j - i > 2 || (j - i == 2 && edges[i].forward == edges[i + 1].forward))
      ++facts.non_manifold_edges;
    if (j - i == 2) {
      ++links[static_cast<std::size_t>(edges[i].low)];
      ++links[static_cast<std::size_t>(edges[i].high)];
    }
    i = j;
  }
  // A closed fan among several is caught by walking, which needs the neighbours: fans are counted
  // by joining the triangles at each vertex through its shared edges.
  std::vector<std::vector<std::pair<int, int>>> joins(mesh.vertices.size());
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    if (edges[i].low == edges[i + 1].low && edges[i].high == edges[i + 1].high)
      for (const int v : {edges[i].low, edges[i].high})
        joins[static_cast<std::size_t>(v)].emplace_back(edges[i].triangle, edges[i + 1].triangle);
  std::vector<std::vector<int>> at(mesh.vertices.size());
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n)
    for (int i = 0; i < 3; ++i)
      at[static_cast<std::size_t>(mesh.triangles[n][i])].push_back(static_cast<int>(n));
  for (std::size_t v = 0; v < at.size(); ++v) {
    if (at[v].size() < 2) continue;
    std::vector<int> reached{at[v][0]};
    for (std::size_t r = 0; r < reached.size(); ++r)
      for (const auto& [a, b] : joins[v])
        for (const int next : {a, b})
          if ((a == reached[r] || b == reached[r]) &&
              std::find(reached.begin(), reached.end(), next) == reached.end())
            reached.push_back(next);
    facts.pinched_vertices += reached.size() != at[v].size();
  }
  const auto piece = pieces_of(mesh);
  for (std::size_t v = 0; v < piece.size(); ++v)
    facts.pieces += corners[v] > 0 && piece[v] == static_cast<int>(v);
  return facts;
}

TriMesh largest_piece(const TriMesh& mesh) {
  const auto piece = pieces_of(mesh);
  std::vector<int> count(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles)
    ++count[static_cast<std::size_t>(piece[static_cast<std::size_t>(t[0])])];
  TriMesh out;
  if (mesh.empty()) return out;
  const int best = static_cast<int>(std::max_element(count.begin(), count.end()) - count.begin());
  std::vector<int> number(mesh.vertices.size(), -1);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (piece[v] != best) continue;
    number[v] = static_cast<int>(out.vertices.size());
    out.vertices.push_back(mesh.vertices[v]);
    if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
  }
  for (const auto& t : mesh.triangles)
    if (piece[static_cast<std::size_t>(t[0])] == best)
      out.triangles.emplace_back(number[static_cast<std::size_t>(t[0])],
                                 number[static_cast<std::size_t>(t[1])],
                                 number[static_cast<std::size_t>(t[2])]);
  return out;
}

}  // namespace condyle
