#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/core/stage_times.h"
#include "engine/math/pose.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/contact_set.h"
#include "sim/frame/face_excitation.h"
#include "sim/frame/measures.h"
#include "sim/frame/muscle_state.h"
#include "sim/frame/tissue_state.h"

namespace condyle {

/// Input of one step.
struct StepInput {
  double time_s = 0;
  // Target pose of each body in its parent's frame, set by the motion, a hand or a plan; missing
  // ones are at rest.
  std::vector<Pose> X_PB_target = {};
  FaceExcitation excitation = {};
  bool obey_contact = true;  // false plays a recording unaltered
  // with contact: large distances may be lower bounds (ContactModel::slide)
  bool bound_far = false;
};

/// The complete state at one time: a plain value to copy to a thread, a file or a test.
struct FrameState {
  double time_s = 0;
  std::vector<Pose> X_PB_target;  // of each body in its parent's frame
  BodyPoses poses;                // reached by the bodies
  bool stopped = false;           // contact kept a body from its target
  ContactSet contacts;
  TissueState tissue;
  std::vector<Eigen::Vector3f>
      face;  // vertices of the displayed face, mm; empty when not requested
  Measures measures;
  MuscleStates muscles;  // of a motion driven by muscles, in the order of the case
  LidClosure lids;       // drawn; excluded from the hash
  StageTimes times;      // measured; excluded from the hash
  std::uint64_t state_hash = 0;
};

}  // namespace condyle
