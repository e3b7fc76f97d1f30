#pragma once

#include <string>
#include <vector>

namespace condyle {

/// Rows of cells as text in aligned columns, two blanks apart. Columns whose letter in `alignment`
/// is 'r' are aligned to the right.
std::string aligned_columns(const std::vector<std::vector<std::string>>& rows,
                            const std::string& alignment);

}  // namespace condyle
