#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/operation/operation.h"
#include "sim/prediction/stripping.h"
#include "sim/tissue/tissue.h"

namespace condyle {

struct PredictionSettings {
  TissueSettings tissue;
  int steps = 10;  // from rest to the planned position
  int threads = 2;
  StrippingSettings stripping;
};

/// A soft landmark before and after, mm, in the cranium's frame.
struct SoftPoint {
  std::string landmark;
  Eigen::Vector3d before, after;
};

/// The face after an operation.
struct Prediction {
  Operated operated;
  std::shared_ptr<const TissueModel> tissue;  // on the operated bodies
  TissueState state;
  Stripping stripping;
  TriMesh face;                                // as displayed, with its lips parted, at rest
  std::vector<Eigen::Vector3f> before, after;  // its vertices
  std::vector<SoftPoint> points;
  /// Largest change of the displayed face in a further round of the solution; 0 where converged.
  double unsettled_mm = 0;
  double time_s = 0;  // of the solves, without building the tissue

  double max_displacement_mm() const;
};

/// Predicts the face: the uncut patient's tissue is held by the segments (see operated_tissue()),
/// which move in steps from rest to their planned poses, and is then solved to equilibrium. Without
/// any move the face is the same, bit for bit.
/// throws: InputError for a case without a face, and as apply_plan().
Prediction predict(const Case& patient, const Plan& plan, const PredictionSettings& settings = {},
                   const Progress& progress = {});

/// Poses of all bodies at a fraction of their moves from rest to the plan: rotations and
/// translations of each body from its own rest, about the centre of its parts.
std::vector<Pose> poses_at(const Operated& operated, double fraction);

}  // namespace condyle
