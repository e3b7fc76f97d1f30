#pragma once

#include <vector>

#include "engine/segmentation/split_bones.h"
#include "sim/anatomy_fit/anatomy_fit.h"

namespace condyle {

/// The bones of a fitted template, with their teeth, as they give seeds.
struct FittedSeeds {
  std::vector<SeedSurface> surfaces;
  double error_mm = 0;  // rms, of the fit; limited to the range that seed_labels() is known for
};
FittedSeeds fitted_seeds(const AnatomyFit& fit);

}  // namespace condyle
