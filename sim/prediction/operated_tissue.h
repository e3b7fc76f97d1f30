#pragma once

#include <memory>

#include "sim/operation/operation.h"
#include "sim/prediction/stripping.h"
#include "sim/tissue/tissue.h"

namespace condyle {

/// The soft tissue of an operated patient.
struct OperatedTissue {
  std::shared_ptr<const TissueModel> model;
  Stripping stripping;
  bool grafted = false;  // bone came in that may push the tissue aside
};

/// The soft tissue of an uncut patient, held by the bodies of the operated one and stripped near
/// the cuts: same mesh, springs and rest, so that the face of a plan is the same model at other
/// poses of the bones. Each triangle of an uncut bone goes with the nearest piece; nothing holds
/// the tissue where bone was resected, and grafts push it aside. The tissue itself where nothing
/// was cut.
/// `uncut`: the patient of `tissue`, from whose bones the plan's were cut.
OperatedTissue operated_tissue(const Case& uncut, const std::shared_ptr<const TissueModel>& tissue,
                               const Operated& operated, const Plan& plan,
                               const StrippingSettings& stripping = {}, int threads = 1);

}  // namespace condyle
