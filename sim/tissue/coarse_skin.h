#pragma once

#include "sim/tissue/columns.h"
#include "sim/tissue/skin_region.h"

namespace condyle {

/// The simulated sheet: about `nodes` vertices over the region, finest at the lips.
CoarseSkin make_coarse_skin(const SkinRegion& region, int nodes);

}  // namespace condyle
