#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "sim/tissue/lips.h"

namespace condyle {

/// The oral fissure, the slit between the lips, projected to the front: z over x from corner to
/// corner. Tissue is not connected across it, so distances are measured around its corners.
class OralFissure {
 public:
  OralFissure() = default;
  OralFissure(const TriMesh& skin, const MouthOutline& mouth);

  bool found() const { return x_.size() > 1; }
  /// Height above the fissure, mm; horizontal beyond the corners.
  double height(const Eigen::Vector3d& p) const;
  int side(const Eigen::Vector3d& p) const { return height(p) >= 0 ? 1 : -1; }
  /// Distance from the line between the corners, mm; infinite without a fissure.
  double distance_from(const Eigen::Vector3d& p) const;
  /// Whether p lies within 3 mm of a corner, as seen from the front.
  bool at_corner(const Eigen::Vector3d& p) const;
  /// Length of the shortest path from p to q that does not cross the fissure; sides as given, +1
  /// above, -1 below.
  double distance(const Eigen::Vector3d& p, int side_p, const Eigen::Vector3d& q, int side_q) const;

  /// At the end of a slit, tissue opens with the square root of the distance to it, a mesh whose
  /// edges are not much shorter than `reach` in proportion to it. The point at which such a mesh
  /// has the displacement that tissue has at p: p itself beyond `reach` of the corners.
  Eigen::Vector3d sampled_at(const Eigen::Vector3d& p, double reach) const;

  template <class Archive>
  void fields(Archive& archive) {  // see engine/core/archive.h
    archive(x_, z_, right_, left_);
  }

 private:
  std::vector<double> x_, z_;
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero(), left_ = Eigen::Vector3d::Zero();
};

/// The lip that each vertex of a skin belongs to.
struct LipSides {
  std::vector<signed char> side;  // +1 upper, -1 lower
  std::vector<double> to_edge;    // distance to its edge along the surface, mm; infinite: unknown
};

/// The nearer lip along the surface, up to `reach` mm from the mouth; by height beyond. `lining`
/// (per vertex; may be empty): belongs to a lip at any distance.
LipSides sides_of(const TriMesh& skin, const MouthOutline& mouth, const OralFissure& fissure,
                  double reach, const std::vector<char>& lining = {});

}  // namespace condyle
