#pragma once

#include <vector>

#include "sim/case/case.h"
#include "sim/tissue/columns.h"

namespace condyle {

/// Determines which columns grow on bone (`attached_to`), and how firmly. Free are the margins of
/// the lips, the cheeks between the jaws (teeth, and bone near the bite), and the skin over the
/// ramus, under the jaw and of the neck.
void attach_columns(const CoarseSkin& skin, const Anatomy& anatomy, const JawBodies& jaw,
                    std::vector<Column>& columns);

/// Applies the plan's own regions: within a region, tissue that lies on its bone is attached or
/// detached. Glued tissue is attached to everything it lies on, teeth included; lips to their own
/// jaw only. `side` of each column: +1 above the lip line, -1 below.
/// throws: InputError for a landmark that the patient lacks.
void attach_as_planned(const TissuePlan& plan, const Landmarks& landmarks, const CoarseSkin& skin,
                       const std::vector<signed char>& side, const JawBodies& jaw,
                       std::vector<Column>& columns);

}  // namespace condyle
