#pragma once

#include <filesystem>
#include <string>

namespace condyle {

/// Path of a file of the user's settings: $XDG_CONFIG_HOME/condyle/NAME, else
/// ~/.config/condyle/NAME; empty without a home.
std::filesystem::path settings_file(const std::string& name);

}  // namespace condyle
