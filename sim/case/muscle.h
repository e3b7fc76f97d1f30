#pragma once

#include <Eigen/Core>
#include <string>

namespace condyle {

/// What a muscle is attached to. The hyoid hangs between both jaws; larynx and breastbone stay
/// where they are.
enum class MuscleBody { cranium, mandible, hyoid, neck };

/// A muscle as a straight line between two points at rest, in the cranium's frame.
struct Muscle {
  std::string name;       // unique in the case: "lat"
  std::string kind;       // the same on both sides: "at"
  std::string full_name;  // "Anterior Temporal"
  std::string group;      // what it does: "closer", "opener"; may be empty
  MuscleBody origin_body = MuscleBody::cranium, insertion_body = MuscleBody::mandible;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(), insertion = Eigen::Vector3d::Zero();
  double max_force_N = 0;        // isometric, at the optimal length
  double optimal_length_mm = 0;  // of fibre and tendon together
  double max_length_mm = 0;      // where the passive force is passive_fraction of the largest
  double tendon_ratio = 0;       // of the optimal length that is tendon
  double passive_fraction = 0;

  bool moves(MuscleBody body) const { return origin_body == body || insertion_body == body; }
};

}  // namespace condyle
