#pragma once

#include "engine/registration/fit_surface.h"
#include "sim/anatomy_fit/anatomy_fit.h"

namespace condyle {

/// A rough place of the template in a scan.
struct FitStart {
  AffineMap map;         // similarity, template to scan
  double explained = 0;  // share of the scan's samples within 5 mm of the template
  ScanFrame frame = ScanFrame::lps;
};

/// The best of many starts: turned, at several heights and depths, so that the scan may show a part
/// of the template only, or more than it. Scan to template: what the scan lacks does not count.
FitStart find_start(const FitSurface& moving, const FitSurface& target, int threads);

}  // namespace condyle
