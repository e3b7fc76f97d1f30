#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/math/pose.h"

namespace condyle {

/// The soft tissue of one frame and the result of its solve; the next frame starts from it.
struct TissueState {
  std::vector<Eigen::Vector3d> nodes;  // mm, in the model's node order; empty without tissue
  // poses of the bodies for which the nodes were solved; missing ones are at rest
  std::vector<Pose> X_CB;
  std::vector<double> excitation = {};  // of the muscles of the face; missing ones are relaxed
  int iterations = 0;
  int evaluations = 0;    // of energy or gradient
  bool converged = true;  // the minimizer and the contact planes, see contact_error_mm
  bool reused = false;    // the solve failed: the nodes are those of an earlier frame
  double energy = 0;      // relative to rest
  double residual = 0;    // largest nodal gradient
  int inverted_prisms = 0;
  double penetration_mm = 0;  // of the deepest point in bone, teeth or other skin, beyond rest
  double slip_mm = 0;  // largest displacement of a point along the bone that it touched at rest
  double contact_error_mm = 0;  // distance of the contact planes from the surfaces they represent
};

}  // namespace condyle
