#pragma once

#include <vector>

#include "sim/tissue/columns.h"

namespace condyle {

/// Says which columns grow on bone (their `hold`). Free are: the lips' margin, the cheeks between
/// the jaws (teeth, and bone near the bite), and the skin under the jaw and of the neck.
void hold_columns(const CoarseSkin& skin, const Anatomy& anatomy, std::vector<Column>& columns);

}  // namespace condyle
