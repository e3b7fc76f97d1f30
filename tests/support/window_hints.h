#pragma once

#include <string>
#include <utility>

namespace condyle {

/// Minimum width and height that the window of this title requests from window managers; 0 without
/// such a window.
std::pair<int, int> min_window_size(const std::string& title);

}  // namespace condyle
