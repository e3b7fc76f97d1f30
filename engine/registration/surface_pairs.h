#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <utility>
#include <vector>

#include "engine/mesh/triangle_tree.h"

namespace condyle {

/// Partner of a point on a surface.
struct SurfacePair {
  double distance = 0;  // mm; positive in front of the surface
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, of the surface there
};

/// Partners of points on a surface that may be open, such as a scan of a face. A point has none
/// where the surface ends (its nearest point lies on the rim) or faces another direction. Queries
/// are const and thread-safe.
class SurfacePairs {
 public:
  /// The mesh must be welded; its triangles face outward.
  explicit SurfacePairs(const TriMesh& surface);

  /// The nearest point of the surface, if its normal is within 60 degrees, or another angle, of
  /// `normal` (unit).
  std::optional<SurfacePair> find(const Eigen::Vector3d& p, const Eigen::Vector3d& normal,
                                  double least_cos = 0.5) const;

  const TriangleTree& tree() const { return tree_; }

 private:
  bool on_rim(const SurfacePoint& found) const;

  TriangleTree tree_;
  std::vector<Eigen::Vector3i> triangles_;
  std::vector<std::pair<int, int>> rim_edges_;  // sorted, lower vertex first
  std::vector<bool> rim_vertex_;
};

}  // namespace condyle
