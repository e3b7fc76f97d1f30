#pragma once

#include <vector>

#include "engine/math/pose.h"
#include "sim/phantom/head_shape.h"

namespace condyle {

/// Smooth map of the built-in patient's space that gives the head another shape. Each anatomical
/// region (joint, arch, orbit, chin, ...) moves as a rigid body; between regions the motions are
/// blended by inverse squared distance. The joints only move sideways, skull and mandible alike,
/// and each arch is rigid, so condyle-fossa relation and occlusion are preserved.
class HeadWarp {
 public:
  /// `bite`: motion of the lower arch against the upper one, at the built-in position.
  HeadWarp(const HeadShape& shape, const Pose& bite);

  // Of points at rest, by what they belong to. mm.
  Eigen::Vector3d skull(const Eigen::Vector3d& p) const;     // also upper teeth, gums and eyes
  Eigen::Vector3d mandible(const Eigen::Vector3d& p) const;  // also lower teeth, gums and tongue
  Eigen::Vector3d skin(const Eigen::Vector3d& p) const;

  /// Signed distance to the region that is rigid about a joint; negative inside.
  static double joint_distance(const Eigen::Vector3d& p);

 private:
  struct Region {
    Eigen::Vector3d center, half;
    double rounding;
    Pose motion;
  };
  using Map = Eigen::Vector3d (HeadWarp::*)(const Eigen::Vector3d&) const;

  static double distance(const Region& region, const Eigen::Vector3d& p);
  static Eigen::Vector3d blended(const std::vector<Region>& regions, const Eigen::Vector3d& p);
  Eigen::Vector3d mirrored(const Eigen::Vector3d& p, Map map) const;
  Eigen::Vector3d warp_skull(const Eigen::Vector3d& p) const;
  Eigen::Vector3d warp_mandible(const Eigen::Vector3d& p) const;
  Eigen::Vector3d warp_skin(const Eigen::Vector3d& p) const;
  Eigen::Vector3d vault(const Eigen::Vector3d& p) const;
  Eigen::Vector3d nose(const Eigen::Vector3d& p) const;

  HeadShape shape_;
  std::vector<Region> skull_, mandible_;
};

}  // namespace condyle
