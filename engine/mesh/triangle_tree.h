#pragma once

#include <Eigen/Core>
#include <array>
#include <cassert>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A point of a surface, as found by a query. `triangle` is -1 when nothing was in reach.
struct SurfacePoint {
  double distance = std::numeric_limits<double>::infinity();  // mm; negative inside where signed
  Eigen::Vector3d point = Eigen::Vector3d::Zero();            // mm
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();      // of the triangle's three corners
  int triangle = -1;                                          // index into the mesh's triangles
};

/// Box tree over the triangles of a surface. It copies its data: the mesh need not outlive it.
/// Queries are const, thread-safe and bitwise deterministic. Triangles without area are never
/// returned.
class TriangleTree {
 public:
  /// Indices must be valid and coordinates finite. Corners at equal coordinates count as one
  /// vertex.
  explicit TriangleTree(const TriMesh& mesh);

  /// The tree of the same triangles with other vertex positions, split as this one: built much
  /// faster, and for `nearest` alone. Triangles that have lost their area may be returned or not.
  TriangleTree moved(const TriMesh& mesh) const;

  bool empty() const { return corners_.empty(); }

  /// Corners of a triangle that has area, such as every returned one.
  const std::array<Eigen::Vector3d, 3>& corners(int triangle) const {
    assert(static_cast<std::size_t>(triangle) < slot_.size());
    assert(slot_[static_cast<std::size_t>(triangle)] >= 0);
    return corners_[static_cast<std::size_t>(slot_[static_cast<std::size_t>(triangle)])];
  }

  /// Nearest surface point not farther than `reach` (mm); unsigned distance.
  SurfacePoint nearest(const Eigen::Vector3d& p,
                       double reach = std::numeric_limits<double>::infinity()) const;

  /// The same with the distance negative on the inner side of the nearest surface (angle-weighted
  /// pseudonormals): inside a closed mesh. Where closed shells overlap, the nearest one decides;
  /// `winding_number` detects the inside of their union.
  SurfacePoint signed_nearest(const Eigen::Vector3d& p,
                              double reach = std::numeric_limits<double>::infinity()) const;

  double signed_distance(const Eigen::Vector3d& p) const { return signed_nearest(p).distance; }

  /// Outward normal (unit) of the face, edge or corner on which a found point lies.
  Eigen::Vector3d pseudonormal(const SurfacePoint& found) const;

  /// Whether `holds(corners, triangle)` of any triangle that may meet the box.
  template <class Test>
  bool any_near(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Test& holds) const {
    if (empty()) return false;
    std::array<int, 128> stack;  // median splits: the depth is log2 of the count
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const int index = stack[--size];
      const Node& node = nodes_[static_cast<std::size_t>(index)];
      if ((node.low.array() > high.array()).any() || (node.high.array() < low.array()).any())
        continue;
      if (node.count == 0) {
        stack[size++] = node.first;
        stack[size++] = index + 1;
        continue;
      }
      for (int i = node.first; i < node.first + node.count; ++i)
        if (const auto at = static_cast<std::size_t>(i); holds(corners_[at], triangle_[at]))
          return true;
    }
    return false;
  }

  /// First hit of the ray origin + t * direction, 0 <= t <= max_t; `distance` is t (in lengths of
  /// `direction`). Both sides of a triangle count.
  std::optional<SurfacePoint> ray_cast(
      const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
      double max_t = std::numeric_limits<double>::infinity()) const;

  /// Winding number of the surface about p: 1 inside, 0 outside a closed mesh, n inside n shells;
  /// in between where shells are open. Exact sum over the triangles, with far ones lumped by
  /// clusters (error below 0.02). source: Barill et al. 2018, first order.
  double winding_number(const Eigen::Vector3d& p) const;

  /// The same at many points within `radius` of `center`, several times as fast; one number each.
  void winding_numbers(const Eigen::Vector3d& center, double radius,
                       std::span<const Eigen::Vector3d> points, std::span<double> found) const;

  /// Memory that it holds.
  std::size_t bytes() const;

 private:
  TriangleTree() = default;
  struct Node {
    Eigen::Vector3d low, high;
    int first = 0;  // of a leaf: its triangles; of an inner node: the right child (left is next)
    int count = 0;  // 0 for inner nodes
  };
  struct Cluster {  // of a node, for the winding number
    Eigen::Vector3d center, area_normal;
    double radius = 0;
  };
  using Corners = std::array<Eigen::Vector3d, 3>;

  int build(std::vector<int>& order, const std::vector<Eigen::Vector3d>& centers, int first,
            int last, const TriMesh& mesh);
  void make_face_normals();
  void make_pseudonormals(const TriMesh& mesh);
  void make_clusters();

  std::vector<Node> nodes_;              // depth first
  std::vector<Cluster> clusters_;        // one per node
  std::vector<Corners> corners_;         // in leaf order
  std::vector<int> triangle_;            // leaf order -> mesh
  std::vector<int> slot_;                // mesh -> leaf order, -1 without area
  std::vector<Corners> edge_normals_;    // leaf order; edge k runs from corner k to k + 1
  std::vector<Corners> corner_normals_;  // leaf order
  std::vector<Eigen::Vector3d> face_normals_;
};

}  // namespace condyle
