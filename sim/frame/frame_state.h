#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/core/stage_times.h"
#include "engine/math/pose.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/contact_set.h"
#include "sim/frame/measures.h"
#include "sim/frame/muscle_state.h"
#include "sim/frame/tissue_state.h"

namespace condyle {

/// What drives one step.
struct StepInput {
  double time_s = 0;
  Pose X_CM_wanted;          // where the motion, or the hand, wants the mandible
  bool obey_contact = true;  // false plays a recording as it is
  bool bound_far = false;    // obeying: nobody looks at the distances (ContactModel::slide)
  // Where the hand or a plan wants each free part, in its carrier's frame (none: as at rest).
  std::vector<Pose> X_BF_wanted = {};
};

/// Everything that is true at one time: a plain value to copy to a thread, a file or a test.
struct FrameState {
  double time_s = 0;
  Pose X_CM_wanted;
  Pose X_CM;             // maps the mandible from rest to now
  bool stopped = false;  // contact kept the mandible from the wanted pose
  ContactSet contacts;
  TissueState tissue;
  std::vector<Eigen::Vector3f>
      face;  // vertices of the displayed face, mm; empty when not asked for
  Measures measures;
  StageTimes times;
  std::uint64_t state_hash = 0;  // of poses, contacts, tissue and measures
  std::vector<Pose> X_CF = {};   // of each free part, in the case's order; none: with its carrier

  MuscleStates muscles = {};  // of a motion driven by muscles, in its order

  BodyPoses poses() const { return {X_CM, X_CF}; }
};

}  // namespace condyle
