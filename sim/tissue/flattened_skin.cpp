#include "sim/tissue/flattened_skin.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <functional>
#include <queue>
#include <utility>

#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/lips.h"

namespace condyle {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

std::size_t nearest_vertex(const TriMesh& mesh, const Vector3d& p) {
  std::size_t nearest = 0;
  for (std::size_t v = 1; v < mesh.vertices.size(); ++v)
    if ((mesh.vertices[v] - p).squaredNorm() < (mesh.vertices[nearest] - p).squaredNorm())
      nearest = v;
  return nearest;
}

/// Vertices whose distance from the nearest of `from` along edges is below `reach_mm`.
std::vector<char> within_reach(const TriMesh& mesh, const std::vector<std::vector<int>>& ring,
                               const std::vector<Vector3d>& from, double reach_mm) {
  std::vector<double> path(mesh.vertices.size(), reach_mm);
  using Reached = std::pair<double, std::size_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
  const auto reach = [&](std::size_t v, double length) {
    if (length >= path[v]) return;
    path[v] = length;
    next.emplace(length, v);
  };
  for (const auto& p : from) reach(nearest_vertex(mesh, p), 0);
  while (!next.empty()) {
    const auto [length, v] = next.top();
    next.pop();
    if (length > path[v]) continue;
    for (int n : ring[v]) reach(n, length + (mesh.vertices[n] - mesh.vertices[v]).norm());
  }
  std::vector<char> within(path.size());
  for (std::size_t v = 0; v < path.size(); ++v) within[v] = path[v] < reach_mm;
  return within;
}

}  // namespace

TriMesh flattened_near(const TriMesh& mesh, const std::vector<Vector3d>& points, double reach_mm) {
  std::vector<std::vector<int>> ring(mesh.vertices.size());
  for (const auto& [a, b] : edges_of(mesh.triangles)) {
    ring[a].push_back(b);
    ring[b].push_back(a);
  }
  std::vector<char> moves = within_reach(mesh, ring, points, reach_mm);
  for (const auto& loop : border_loops(mesh))
    for (int v : loop) moves[v] = 0;

  std::vector<int> row(moves.size(), -1), vertex;
  for (std::size_t v = 0; v < moves.size(); ++v)
    if (moves[v]) {
      row[v] = static_cast<int>(vertex.size());
      vertex.push_back(static_cast<int>(v));
    }
  TriMesh flat = mesh;
  if (vertex.empty()) return flat;
  const auto size = static_cast<Index>(vertex.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d fixed = Eigen::MatrixX3d::Zero(size, 3);  // sum of the neighbours that stay
  for (Index i = 0; i < size; ++i) {
    const std::vector<int>& around = ring[vertex[i]];
    entries.emplace_back(i, i, static_cast<double>(around.size()));
    for (int n : around)
      if (row[n] >= 0)
        entries.emplace_back(i, row[n], -1.0);
      else
        fixed.row(i) += mesh.vertices[n].transpose();
  }
  Eigen::SparseMatrix<double> laplacian(size, size);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(laplacian);
  if (factor.info() != Eigen::Success) return flat;
  const Eigen::MatrixX3d means = factor.solve(fixed);
  for (Index i = 0; i < size; ++i) flat.vertices[vertex[i]] = means.row(i).transpose();
  return flat;
}

}  // namespace condyle
