#pragma once

#include "sim/tissue/tissue.h"

namespace condyle {

/// The published test of robustness on a patient: with the mouth open, the mandible moves 1 mm
/// forward at once, or in ten steps of 0.1 mm. Each step is solved as a frame is; the last one is
/// solved to equilibrium.
struct StepIndependence {
  Pose X_CM;                 // the opened mandible, before it moves forward
  double moved_mm = 0;       // largest displacement of any node in that last mm
  double difference_mm = 0;  // largest distance of any node between the two, at equilibrium
  double of_frames_mm = 0;   // the same before equilibrium
  bool settled = false;      // both reached equilibrium
};
/// `opening_rad`: of the opening path. Deterministic for any number of threads.
StepIndependence step_independence(const TissueModel& model, double opening_rad, int threads = 1);

}  // namespace condyle
