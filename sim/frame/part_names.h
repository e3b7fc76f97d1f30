#pragma once

#include <span>
#include <string>

namespace condyle {

/// The readable name of a part or landmark within a sentence: "left condyle fossa" for
/// left_condyle_fossa. Files and the command line use the name itself.
std::string readable_name(std::string name);
/// The same at the start of a label: "Left condyle fossa".
std::string display_name(const std::string& name);

/// A sentence with these names made readable where they are words; paths are unchanged.
std::string with_readable_names(std::string sentence, std::span<const std::string> names);

}  // namespace condyle
