#pragma once

#include "sim/case/tissue_plan.h"
#include "tools/commands.h"

namespace condyle {

/// What the command line says of the soft tissue. throws: InputError naming option and value.
TissuePlan parse_tissue(const TissueOptions& options);

}  // namespace condyle
