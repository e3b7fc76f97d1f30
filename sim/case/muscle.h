#pragma once

#include <Eigen/Core>
#include <string>

namespace condyle {

/// The body to which a muscle is attached. The hyoid is suspended by muscles; larynx and sternum
/// are fixed.
enum class MuscleBody { cranium, mandible, hyoid, neck };

/// A muscle as a straight line between two points at rest, in the cranium's frame.
struct Muscle {
  std::string name;       // unique in the case: "lat"
  std::string kind;       // the same on both sides: "at"
  std::string full_name;  // "Anterior Temporal"
  std::string group;      // function: "closer", "opener"; may be empty
  MuscleBody origin_body = MuscleBody::cranium, insertion_body = MuscleBody::mandible;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(), insertion = Eigen::Vector3d::Zero();
  double max_force_N = 0;        // isometric, at the optimal length
  double optimal_length_mm = 0;  // fibre and tendon together
  double max_length_mm = 0;  // length at which the passive force is passive_fraction of max_force_N
  double tendon_ratio = 0;   // tendon over optimal length
  double passive_fraction = 0;

  bool moves(MuscleBody body) const { return origin_body == body || insertion_body == body; }
};

}  // namespace condyle
