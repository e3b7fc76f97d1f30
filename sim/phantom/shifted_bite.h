#pragma once

#include "engine/math/pose.h"
#include "sim/case/case.h"

namespace condyle {

/// Motion that places the lower arch `forward_mm` ahead of its position and closes it again, by
/// lowering and pitching, until teeth in front and behind meet. The least distance between the
/// arches is then 0.05 to 0.1 mm, as on the built-in patient. No motion for 0 mm.
Pose shifted_bite(const Case& patient, double forward_mm);

}  // namespace condyle
