#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/pair_rule.h"

namespace condyle {

/// One contact between surfaces A and B, in the cranium's frame.
struct ContactPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // mm
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from A to B
};

/// What one pair of parts does at one pose.
struct PairContact {
  // Indices into the case's parts. Cranium before mandible before free parts; two free ones in
  // their order.
  int part_a = 0, part_b = 0;
  bool touching = false;
  std::vector<ContactPoint> contacts;                   // capped
  double distance_mm = 0;                               // exact least, 0 when touching; or a bound
  Eigen::Vector3d witness_a = Eigen::Vector3d::Zero();  // nearest points when apart
  Eigen::Vector3d witness_b = Eigen::Vector3d::Zero();
  int triangle_a = -1, triangle_b = -1;  // triangles of the witness points: the next query's start
  // Deepest point of either surface inside the other, 0 when apart. Where the surfaces were apart
  // at rest, depth counts from the rest depth on: depth_mm - rest_depth_mm is what is new.
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
  /// Deepest overlap beyond what was there at rest, over the pairs.
  double max_penetration_mm() const;

  Pose X_CM;               // where it was taken
  std::vector<Pose> X_CF;  // the same of the free parts

  // Of pairs that overlap at rest, in their order: the mandible's surface away from that overlap,
  // which may not touch at all. What it does is counted into the pairs' depths.
  std::vector<PairContact> away_from_rest;
};

}  // namespace condyle
