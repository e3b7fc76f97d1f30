#pragma once

#include <vector>

#include "engine/segmentation/split_bones.h"
#include "sim/anatomy_fit/anatomy_fit.h"

namespace condyle {

/// The bones of a fitted template, with their teeth, from which seeds are taken.
struct FittedSeeds {
  std::vector<SeedSurface> surfaces;
  double error_mm = 0;  // the larger rms of both fits, clamped to the range that is measured
};
FittedSeeds fitted_seeds(const AnatomyFit& fit);

}  // namespace condyle
