#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "sim/case/case.h"
#include "sim/frame/body_tree.h"

namespace condyle {

/// Anatomy of this patient at rest: landmarks, or estimates from the bones where a landmark is
/// missing (stated in the notes). mm, LPS.
struct Anatomy {
  Eigen::Vector3d condyles = Eigen::Vector3d::Zero();  // midpoint of both
  Eigen::Vector3d incisors = Eigen::Vector3d::Zero();  // midpoint of upper and lower incisal point
  double mandible_low = 0;                             // z of the lowest point of the mandible
  double mandible_back = 0;                            // y of its rearmost point

  /// Height of the occlusal plane at a point: through the incisors, rising to the back by the
  /// average angle between occlusal and Frankfort plane.
  double bite_height(double y) const { return incisors.z() + 0.1 * (y - incisors.y()); }
};

/// Bones and teeth that a march from the skin can hit.
struct Bones {
  JawBodies jaw;
  TriangleTree cranium, mandible;  // bone with teeth
  TriangleTree teeth;              // of both jaws, where they are separate; may be empty
};

Anatomy read_anatomy(const Case& patient, std::vector<std::string>& notes);
Bones collect_bones(const Case& patient);

/// Bone and teeth of one jaw as one mesh; empty when there are none.
TriMesh jaw_mesh(const Case& patient, BodyId body);

}  // namespace condyle
