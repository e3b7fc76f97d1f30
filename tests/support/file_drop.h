#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace condyle::test {

/// Drops files on a window as a file manager does, by the XDND protocol (version 5) of the X server
/// that DISPLAY names: a source window owns the selection and answers for it.
/// Returns whether the window has accepted them.
bool drop_files(const std::string& window_title, const std::vector<std::filesystem::path>& files);

}  // namespace condyle::test
