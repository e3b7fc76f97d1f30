#pragma once

#include <span>
#include <string>

namespace condyle {

/// The name of a part or a landmark as people read it within a sentence: "left condyle fossa" for
/// left_condyle_fossa. Files and the command line keep the name itself.
std::string readable_name(std::string name);
/// The same where it stands alone: "Left condyle fossa".
std::string display_name(const std::string& name);

/// A sentence with these names readable where they stand as words; in paths they stay.
std::string with_readable_names(std::string sentence, std::span<const std::string> names);

}  // namespace condyle
