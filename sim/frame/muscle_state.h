#pragma once

#include <vector>

namespace condyle {

/// One muscle at one time.
struct MuscleState {
  double excitation = 0;  // 0 to 1
  double activation = 0;  // follows the excitation
  double length_mm = 0;
  double speed_mm_s = 0;  // lengthening
  double force_N = 0;
};

/// In the order of the case's muscles; empty when the motion is not driven by muscles.
using MuscleStates = std::vector<MuscleState>;

}  // namespace condyle
