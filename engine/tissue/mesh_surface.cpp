#include "engine/tissue/mesh_surface.h"

#include <algorithm>
#include <utility>

namespace condyle {
namespace {

std::array<int, 2> edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace

MeshSurface::MeshSurface(std::vector<std::array<int, 3>> triangles, const Nodes& rest)
    : triangles_(std::move(triangles)) {
  for (const auto& t : triangles_) nodes_.insert(nodes_.end(), t.begin(), t.end());
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  const auto corner_of = [&](int node) {
    return static_cast<int>(std::lower_bound(nodes_.begin(), nodes_.end(), node) - nodes_.begin());
  };
  std::vector<std::array<int, 2>> edges;
  for (const auto& t : triangles_) {
    const Eigen::Vector3i corners(corner_of(t[0]), corner_of(t[1]), corner_of(t[2]));
    corners_.push_back(corners);
    for (int k = 0; k < 3; ++k) edges.push_back(edge(corners[k], corners[(k + 1) % 3]));
  }
  std::sort(edges.begin(), edges.end());
  rim_corner_.assign(nodes_.size(), 0);
  for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
    while (next < edges.size() && edges[next] == edges[i]) ++next;
    if (next - i > 1) continue;
    rim_edges_.push_back(edges[i]);
    for (int end : edges[i]) rim_corner_[static_cast<std::size_t>(end)] = 1;
  }
  tree_ = std::make_shared<const TriangleTree>(placed(rest));
}

TriMesh MeshSurface::placed(const Nodes& x) const {
  TriMesh mesh;
  mesh.vertices.reserve(nodes_.size());
  for (int node : nodes_) mesh.vertices.push_back(x[node]);
  mesh.triangles = corners_;
  return mesh;
}

bool MeshSurface::on_rim(int triangle, const Eigen::Vector3d& barycentric) const {
  const auto& corners = corners_[static_cast<std::size_t>(triangle)];
  std::array<int, 3> on{};
  int count = 0;
  for (int k = 0; k < 3; ++k)
    if (barycentric[k] > 0) on[static_cast<std::size_t>(count++)] = corners[k];
  if (count == 1) return rim_corner_[static_cast<std::size_t>(on[0])] != 0;
  return count == 2 && std::binary_search(rim_edges_.begin(), rim_edges_.end(), edge(on[0], on[1]));
}

std::size_t MeshSurface::bytes() const {
  const auto held = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  return held(triangles_) + held(nodes_) + held(corners_) + held(rim_corner_) + held(rim_edges_) +
         (tree_ ? tree_->bytes() : 0);
}

}  // namespace condyle
