#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/cut/region.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A triangle between two cells.
struct CellFace {
  std::array<int, 3> vertices;
  int front, back;  // cells: the normal points from back to front; -1: air
  int source;       // triangle of the mesh, -1 on a wall
  int wall;         // mark of the plane that made it, -1 on the mesh
};

/// The inside of a closed mesh, divided into cells by planes. Each face knows the cells on both of
/// its sides, and a plane divides the chosen cells alone, so unions of cells are closed whatever
/// the rounding. No exact arithmetic is needed.
class CellComplex {
 public:
  /// One cell: the inside of the mesh, whose edges must be balanced (see unbalanced_edges()).
  explicit CellComplex(const TriMesh& mesh);

  int cells() const { return cells_; }
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }
  const std::vector<CellFace>& faces() const { return faces_; }

  /// A vertex on an edge: (1 - fraction) · low + fraction · high.
  struct EdgePoint {
    int low, high;
    double fraction;
  };
  /// Of the vertices that the mesh does not have, in order.
  const std::vector<EdgePoint>& edge_points() const { return edge_points_; }

  /// Result of a split, by cell that existed before: its side, or both.
  struct Split {
    Region::Side side = Region::Side::unknown;  // of the cell, which keeps the upper part of two
    int lower = -1;                             // number of the new cell below the plane
  };
  /// Divides the cells in `active` (one flag per cell) by a plane; its faces get the mark `wall`.
  /// Vertices within 1e-7 mm of the plane lie on it.
  std::vector<Split> split(const Plane& plane, int wall, std::span<const char> active);

  /// Triangles of walls that face backward, where the mesh crosses itself.
  int turned() const { return turned_; }

 private:
  struct Division;
  void find_signs(Division& division) const;
  void divide_edges(Division& division);
  void divide_faces(Division& division);
  void divide_crossed(Division& division, const CellFace& face, std::span<const int, 3> middles);
  std::vector<Split> assign_cells(Division& division);
  void close_cells(const Division& division, const std::vector<Split>& splits, int wall);

  std::vector<Eigen::Vector3d> vertices_;
  std::vector<EdgePoint> edge_points_;
  std::vector<CellFace> faces_;
  int cells_ = 1, turned_ = 0;
};

/// Edges that are traversed more often in one sense than in the other: those of holes and of
/// neighbours that disagree on outside.
int unbalanced_edges(const TriMesh& mesh);

}  // namespace condyle
