#pragma once

#include <string>
#include <utility>

namespace condyle {

/// The least width and height that the window of this title asks window managers for; 0 without
/// such a window.
std::pair<int, int> min_window_size(const std::string& title);

}  // namespace condyle
