#pragma once

#include "engine/math/pose.h"
#include "sim/appliance/splint.h"

namespace condyle {

/// How far the lower arch turns about the axis through the condyles.
struct BiteOpening {
  Pose X_lower;
  double deg = 0, incisal_mm = 0;      // positive: opened
  double before_mm = 0, after_mm = 0;  // least distance of the arches, up to 1 mm more than needed
};

/// Opens the bite until the arches are `room_mm` apart; no further than is needed, and never closes
/// it. throws: InputError without condyles where an opening is needed, or where none suffices.
BiteOpening open_bite(const SplintArches& arches, double room_mm, int threads);

/// Turns the lower arch by this opening at its incisal edge. throws: InputError where the arches
/// are then not `room_mm` apart, stating what is needed.
BiteOpening turn_bite(const SplintArches& arches, double incisal_mm, double room_mm, int threads);

}  // namespace condyle
