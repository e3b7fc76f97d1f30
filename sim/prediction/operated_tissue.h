#pragma once

#include <memory>

#include "sim/operation/operation.h"
#include "sim/tissue/tissue.h"

namespace condyle {

/// The soft tissue of an uncut patient, held by the bodies of the operated one: same mesh, springs
/// and rest, so that the face of a plan is the same model at other poses of the bones. Each
/// triangle of an uncut bone goes with the nearest piece. The model itself where nothing was cut.
/// `uncut`: the patient of `tissue`, from whose bones the plan's were cut.
std::shared_ptr<const TissueModel> operated_tissue(const Case& uncut,
                                                   const std::shared_ptr<const TissueModel>& tissue,
                                                   const Operated& operated, int threads = 1);

}  // namespace condyle
