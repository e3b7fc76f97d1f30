#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "engine/tissue/spring_prism.h"

namespace condyle {

/// A part of the surface of the mesh. Data that do not change with the nodes' positions are
/// computed once.
class MeshSurface {
 public:
  MeshSurface() = default;
  /// triangles: of nodes, counter-clockwise seen from outside. rest: positions of all nodes.
  MeshSurface(std::vector<std::array<int, 3>> triangles, const Nodes& rest);

  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
  bool empty() const { return triangles_.empty(); }

  /// The surface with all nodes at x; triangles as above, indexing `nodes`.
  TriMesh placed(const Nodes& x) const;
  const std::vector<int>& nodes() const { return nodes_; }
  TriangleTree tree(const TriMesh& placed) const { return tree_->moved(placed); }

  /// Whether a point of the triangle lies on the surface's rim.
  bool on_rim(int triangle, const Eigen::Vector3d& barycentric) const;

  /// Memory that it holds.
  std::size_t bytes() const;

 private:
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> nodes_;  // rising
  std::vector<Eigen::Vector3i> corners_;
  std::vector<char> rim_corner_;               // of each of its nodes
  std::vector<std::array<int, 2>> rim_edges_;  // ascending, each
  std::shared_ptr<const TriangleTree> tree_;   // at rest
};

}  // namespace condyle
