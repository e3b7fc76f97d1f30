#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/frame/body_poses.h"
#include "sim/frame/pair_rule.h"

namespace condyle {

/// One contact between surfaces A and B, in the cranium's frame.
struct ContactPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // mm
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from A to B
};

/// Contact or clearance of one pair of parts at one pose.
struct PairContact {
  // Indices into the case's parts: A's body comes before B's.
  int part_a = 0, part_b = 0;
  bool touching = false;
  std::vector<ContactPoint> contacts;  // capped
  double distance_mm = 0;              // exact minimum, 0 when touching; or a lower bound
  // The nearest points; where the surfaces touch, both are the deepest point.
  Eigen::Vector3d witness_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d witness_b = Eigen::Vector3d::Zero();
  // triangles of the witness points, where the next query starts
  int triangle_a = -1, triangle_b = -1;
  // Deepest point of either surface inside the other, 0 when apart. Where the surfaces were apart
  // at rest, depth counts from the depth at rest: depth_mm - rest_depth_mm is the excess.
  double depth_mm = 0;
  double rest_depth_mm = 0;  // the same at rest: the pair's baseline
  PairPolicy policy = PairPolicy::forbidden;
  bool distance_is_bound = false;  // at least distance_mm, without witness points

  double signed_distance_mm() const { return touching ? -depth_mm : distance_mm; }
};

struct ContactSet {
  std::vector<PairContact> pairs;

  int contact_count() const {
    int count = 0;
    for (const auto& pair : pairs) count += static_cast<int>(pair.contacts.size());
    return count;
  }
  /// Smallest distance over the pairs, 0 when any touches. Infinite without pairs.
  double min_clearance_mm() const;
  /// Deepest overlap beyond the overlap at rest, over the pairs.
  double max_penetration_mm() const;

  BodyPoses at;  // poses of the query

  // For pairs that overlap at rest, in their order: B's surface outside that overlap, where no
  // contact is allowed. Its depth is included in that of the pairs.
  std::vector<PairContact> outside_rest_overlap;
};

}  // namespace condyle
