#pragma once

#include <vector>

#include "sim/case/case.h"
#include "sim/tissue/columns.h"

namespace condyle {

/// Says which columns grow on bone (their `hold`), and how firmly. Free are: the lips' margin, the
/// cheeks between the jaws (teeth, and bone near the bite), the skin over the ramus, under the jaw
/// and of the neck.
void hold_columns(const CoarseSkin& skin, const Anatomy& anatomy, std::vector<Column>& columns);

/// The plan's own regions, on top of that: where tissue lies on their bone within them it is
/// attached, or is not. Glued tissue is held by all that it lies on, teeth too; lips by their own
/// jaw alone. `side` of each column: +1 above the lip line, -1 below.
/// throws: InputError for a landmark that the patient does not have.
void hold_as_planned(const TissuePlan& plan, const Landmarks& landmarks, const CoarseSkin& skin,
                     const std::vector<signed char>& side, std::vector<Column>& columns);

}  // namespace condyle
