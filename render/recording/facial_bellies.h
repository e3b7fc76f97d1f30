#pragma once

#include "render/overlay/overlays.h"
#include "sim/tissue/tissue.h"

namespace condyle {

/// Muscles of facial expression as flat straps along their lines in the soft tissue, in one body.
FibreBody facial_bellies(const TissueModel& model, const TissueState& now);

}  // namespace condyle
