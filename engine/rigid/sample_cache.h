#pragma once

#include "engine/math/pose.h"

namespace condyle {

/// Key of the cached sample selections of one surface in the field of another: the selections
/// depend on nothing else. Poses of the surface in field coordinates.
struct SampleCacheKey {
  Pose near_at;          // at which the near samples were collected
  Pose sifted_at;        // at which the relevant samples were selected from the near ones
  double within_mm = 0;  // largest gap of the selection
  int wide_parts = 0;    // number of successive substeps for which within_mm was far too large
};

}  // namespace condyle
