#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace condyle {

/// Canonical name of a landmark: aliases ("ltmj", "Condyle L", "L1 edge", "Pog'") become the names
/// of sim/case/landmarks.h; unknown names become lower case words joined by '_'. Empty when the
/// name has no letter or digit.
std::string canonical_landmark(std::string_view name);

/// Canonical names of all known landmarks.
std::vector<std::string> landmark_names();

}  // namespace condyle
