#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace condyle {

/// Canonical name of a landmark: aliases ("ltmj", "Condyle L", "L1 edge", "Pog'") become the names
/// of sim/case/landmarks.h; unknown names become lower case words joined by '_'. Empty when the
/// name has no letter or digit.
std::string canonical_landmark(std::string_view name);

/// Names of the landmarks of a permanent tooth: upper_left_canine_tip and upper_left_canine_apex;
/// premolars have a buccal_cusp, molars a mesiobuccal_cusp and a mesiobuccal_apex.
struct ToothLandmarkNames {
  std::string tip, apex;
};
/// Of a permanent tooth, 11 to 48. throws: std::out_of_range.
ToothLandmarkNames tooth_landmark_names(int fdi);

/// Canonical names of all known landmarks.
std::vector<std::string> landmark_names();

}  // namespace condyle
