#pragma once

#include <string>
#include <vector>

#include "sim/tissue/columns.h"

namespace condyle {

/// Checks that the face covers the bones as skin does. throws: InputError when it lies inside them,
/// on them (tissue without thickness), or too far away to be of the same patient. Minor oddities go
/// to the notes: columns that end in bone, or hit none.
void check_placement(const CoarseSkin& skin, const Bones& bones, const std::vector<Column>& columns,
                     const ColumnSettings& settings, std::vector<std::string>& notes);

/// throws: InputError when nothing holds the tissue; a note when nothing holds it on a jaw that the
/// patient has.
void check_attachment(int to_cranium, int to_mandible, const Bones& bones,
                      std::vector<std::string>& notes);

}  // namespace condyle
