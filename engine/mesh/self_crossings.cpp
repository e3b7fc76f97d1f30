#include "engine/mesh/self_crossings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "engine/core/parallel.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr std::size_t chunk_edges = 2048;

/// Six times the signed volume of a tetrahedron.
double volume6(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Whether the segment from a to b passes through the inside of a triangle.
bool passes_through(const Vector3d& a, const Vector3d& b, const std::array<Vector3d, 3>& t) {
  const double from = volume6(t[0], t[1], t[2], a), to = volume6(t[0], t[1], t[2], b);
  if (from == 0 || to == 0 || (from < 0) == (to < 0)) return false;
  const std::array<double, 3> sides = {volume6(a, b, t[0], t[1]), volume6(a, b, t[1], t[2]),
                                       volume6(a, b, t[2], t[0])};
  return std::all_of(sides.begin(), sides.end(), [](double s) { return s > 0; }) ||
         std::all_of(sides.begin(), sides.end(), [](double s) { return s < 0; });
}

}  // namespace

std::vector<int> self_crossings(const TriMesh& mesh, int threads) {
  const EdgeList edges = find_edges(mesh);
  const TriangleTree tree(mesh);
  const auto vertex = [&](int v) -> const Vector3d& {
    return mesh.vertices[static_cast<std::size_t>(v)];
  };
  std::vector<std::vector<int>> found((edges.edges.size() + chunk_edges - 1) / chunk_edges);
  parallel_for(found.size(), threads, [&](std::size_t chunk) {
    const std::size_t last = std::min(edges.edges.size(), (chunk + 1) * chunk_edges);
    for (std::size_t e = chunk * chunk_edges; e < last; ++e) {
      const Edge& edge = edges.edges[e];
      const Vector3d &a = vertex(edge.low), &b = vertex(edge.high);
      const std::size_t before = found[chunk].size();
      tree.any_near(a.cwiseMin(b), a.cwiseMax(b),
                    [&](const std::array<Vector3d, 3>& corners, int triangle) {
                      const auto& t = mesh.triangles[static_cast<std::size_t>(triangle)];
                      if ((t.array() == edge.low || t.array() == edge.high).any()) return false;
                      if (passes_through(a, b, corners)) found[chunk].push_back(triangle);
                      return false;
                    });
      if (found[chunk].size() == before) continue;
      for (int side = 0; side < edge.count; ++side)
        found[chunk].push_back(edges.sides[static_cast<std::size_t>(edge.first + side)].triangle);
    }
  });
  std::vector<int> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::size_t uncross(TriMesh& mesh, const std::vector<Vector3d>& before, int threads) {
  constexpr int rounds = 8;
  const std::vector<Vector3d> moved = mesh.vertices;
  std::vector<double> share(mesh.vertices.size(), 1);  // of the move
  for (int round = 0; round < rounds; ++round) {
    const std::vector<int> crossing = self_crossings(mesh, threads);
    if (crossing.empty()) return 0;
    std::vector<char> back(mesh.vertices.size(), 0);
    for (const int t : crossing)
      for (const int v : mesh.triangles[static_cast<std::size_t>(t)])
        back[static_cast<std::size_t>(v)] = 1;
    for (std::size_t v = 0; v < back.size(); ++v) {
      if (!back[v]) continue;
      share[v] = share[v] > 0.3 ? 0.5 * share[v] : 0;
      mesh.vertices[v] = before[v] + share[v] * (moved[v] - before[v]);
    }
  }
  return self_crossings(mesh, threads).size();
}

void unfold_apart(TriMesh& mesh, const UnfoldSettings& settings, int threads) {
  const std::vector<Vector3d> before = mesh.vertices;
  unfold(mesh, settings);
  uncross(mesh, before, threads);
}

}  // namespace condyle
