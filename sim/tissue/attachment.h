#pragma once

#include <vector>

#include "sim/tissue/columns.h"

namespace condyle {

/// What holds the innermost node of a column, or any node of a rim column.
enum class Hold { free, cranium, mandible };

/// Which columns grow on bone. Free are: the lips' margin, the cheeks between the jaws (teeth, and
/// bone near the bite), and the skin under the jaw and of the neck, which only slide.
std::vector<Hold> hold_columns(const CoarseSkin& skin, const std::vector<Column>& columns,
                               const Anatomy& anatomy);

}  // namespace condyle
