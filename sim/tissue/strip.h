#pragma once

#include <memory>
#include <span>

#include "sim/tissue/tissue.h"

namespace condyle {

/// The model with weaker anchors, as after a surgeon has lifted periosteum from bone: `kept` of
/// each anchor is the fraction of its stiffness that remains, above 0 to 1. Each anchor keeps its
/// force at rest, so that nothing moves there. Tissue that has lost more than half of its
/// attachment slides on the bones and must not penetrate them. The model itself where all are 1.
std::shared_ptr<const TissueModel> strip_anchors(const std::shared_ptr<const TissueModel>& model,
                                                 std::span<const double> kept);

}  // namespace condyle
