#pragma once

#include <string>
#include <string_view>

namespace condyle {

/// Canonical name of a landmark: aliases ("ltmj", "Condyle L", "L1 edge", "Pog'") become the names
/// of sim/case/landmarks.h; a name that is not known becomes lower case words joined by '_'.
/// Empty when the name has no letter or digit.
std::string canonical_landmark(std::string_view name);

}  // namespace condyle
