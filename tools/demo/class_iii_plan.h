#pragma once

#include "engine/core/progress.h"
#include "sim/operated/segment_bite.h"
#include "tools/command.h"

namespace condyle {

/// The built-in class III patient with the published plan: after Le Fort I the upper jaw 4 mm
/// forward, 2 mm up in front and 4 mm up behind; after sagittal split the lower arch in the bite.
struct ClassIiiPlan {
  Case patient;
  Plan plan;
  SegmentBite bite;
  double setback_mm = 0;  // of the lower incisal point, along the patient's own axis
};
ClassIiiPlan make_class_iii_plan(int threads, const Progress& progress);

}  // namespace condyle
