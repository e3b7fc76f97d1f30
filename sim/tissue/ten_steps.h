#pragma once

#include "sim/tissue/tissue.h"

namespace condyle {

/// The published test of robustness on a patient: with the mouth open, the mandible goes 1 mm
/// forward at once, or in ten steps of 0.1 mm. Each step is followed as a frame is, the last one
/// settled.
struct TenSteps {
  Pose X_CM;                 // the opened mandible, before it goes forward
  double moved_mm = 0;       // farthest way of any node in that last mm
  double difference_mm = 0;  // largest distance of any node between the two, settled
  double of_frames_mm = 0;   // the same before they were settled
  bool settled = false;
};
/// `opening_rad`: of a plain opening. Same bits for any number of threads.
TenSteps ten_steps(const TissueModel& model, double opening_rad, int threads = 1);

}  // namespace condyle
