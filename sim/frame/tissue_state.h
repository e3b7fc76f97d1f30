#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/math/pose.h"

namespace condyle {

struct NearJaws;
class RollingFactor;
struct Touch;

/// Where the soft tissue is, and how its minimiser ended. The next frame starts from it.
struct TissueState {
  std::vector<Eigen::Vector3d> nodes;  // mm, in the model's node order; empty without tissue
  Pose X_CM;                           // mandible pose that this state answers
  int iterations = 0;
  int evaluations = 0;    // of energy or gradient
  bool converged = true;  // the solve, and what it touches: see contact_error_mm
  bool kept = false;      // the solve failed: this is still the tissue of an earlier frame
  double energy = 0;      // relative to rest
  double residual = 0;    // largest nodal gradient
  int inverted_prisms = 0;
  double penetration_mm = 0;    // deepest point in bone, teeth or the other lip, beyond rest
  double slip_mm = 0;           // farthest way of a point along the jaw that it lay on at rest
  double contact_error_mm = 0;  // how far what was taken for the surfaces touched is from them
  /// What the next frame is solved with: a factor of an earlier frame's tissue, or none.
  std::shared_ptr<const RollingFactor> factor;
  /// What the tissue touches and how it presses: lists of things touched; or none.
  std::shared_ptr<const std::vector<std::vector<Touch>>> touches;
  /// How near bone and teeth its points were at the last look, or none. Changes no answer.
  std::shared_ptr<const NearJaws> near;
};

}  // namespace condyle
