#pragma once

#include <string>
#include <string_view>

namespace condyle {

// Texts of a header may hold names of people, whatever their field is meant for. Only words that
// are known are shown.

/// "CT", "MR" and so on; "other" for an unknown text.
std::string shown_modality(std::string_view text);

/// A reconstruction kernel that has the form of a manufacturer's, such as "B30f", "FC08", "BONE";
/// "other" for another text, empty for none.
std::string shown_kernel(std::string_view text);

/// "Siemens", "GE" and so on; empty for an unknown text.
std::string shown_manufacturer(std::string_view text);

}  // namespace condyle
