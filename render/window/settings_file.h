#pragma once

#include <filesystem>
#include <string>

namespace condyle {

/// Where a file of the person's own settings stands: $XDG_CONFIG_HOME/condyle/NAME, else
/// ~/.config/condyle/NAME; empty without a home.
std::filesystem::path settings_file(const std::string& name);

}  // namespace condyle
