#pragma once

#include <optional>

#include "engine/core/progress.h"
#include "engine/volume/volume.h"

namespace condyle {

/// A scan whose slices with metal, such as fillings, were corrected.
struct CorrectedScan {
  Volume volume;
  int slices = 0;  // number of those corrected
};

/// Reduces the streaks of metal: in each slice with at least 4 mm^2 of it the projections through
/// metal are interpolated from those beside it. Metal keeps its values; where they exceeded the
/// scanner's range and became low, they get its end. None without metal. Streaks lie in the slices
/// across the lattice axis that is nearest to the vertical.
/// Source: Kalender, Hebel, Ebersberger, Radiology 164 (1987) 576, on projections of the image.
std::optional<CorrectedScan> reduce_metal_artifacts(const Volume& volume, int threads,
                                                    const Progress& progress = {});

}  // namespace condyle
