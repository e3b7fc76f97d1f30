#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// One rim of an open surface: boundary edges joined end to end.
struct BoundaryLoop {
  int edges = 0;
  double length_mm = 0;
  Box box;
};

/// Connectivity of the triangles of a welded mesh.
struct Topology {
  int components = 0;                  // joined by shared vertices
  int boundary_edges = 0;              // with one triangle
  std::vector<BoundaryLoop> boundary;  // longest first
  int nonmanifold_edges = 0;           // with three triangles or more
  Box nonmanifold_box;                 // where those lie
  int misoriented_edges = 0;           // whose two triangles traverse it in the same direction
  double volume_mm3 = 0;               // signed; meaningful if closed

  /// Every edge has two triangles that agree on outside.
  bool closed() const {
    return components > 0 && boundary_edges == 0 && nonmanifold_edges == 0 &&
           misoriented_edges == 0;
  }
};

Topology inspect(const TriMesh& mesh);

/// Component of each triangle, numbered by first appearance; components share no vertex.
struct Components {
  int count = 0;
  std::vector<int> of_triangle;
};
Components find_components(const TriMesh& mesh);

/// An undirected edge with the triangles at it: `sides[first .. first + count)` of an EdgeList.
struct Edge {
  int low = 0, high = 0;  // vertices, low < high
  int first = 0, count = 0;
};
struct EdgeSide {
  int triangle = 0;
  bool forward = false;  // the triangle runs from low to high
};
struct EdgeList {
  std::vector<Edge> edges;      // sorted by (low, high)
  std::vector<EdgeSide> sides;  // by triangle within an edge
};
/// All edges; triangles that repeat a vertex are left out.
EdgeList find_edges(const TriMesh& mesh);

}  // namespace condyle
