#pragma once

#include <X11/Xlib.h>

#include <string>

namespace condyle::test {

/// The window whose title ends so, below `from`; 0 when there is none.
Window window_called(Display* display, Window from, const std::string& title);

}  // namespace condyle::test
