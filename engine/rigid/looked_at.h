#pragma once

#include "engine/math/pose.h"

namespace condyle {

/// Where the samples of one surface were looked at in the field of another: what is looked at from
/// there on depends on nothing else. Poses of the surface in the field's coordinates.
struct LookedAt {
  Pose near_at;          // where those that are near were searched
  Pose sifted_at;        // where those that can matter were sifted from the near ones
  double within_mm = 0;  // gap at which they can
  int wide_parts = 0;    // of steps in a row for which that was far too much
};

}  // namespace condyle
