#include "tests/support/x11_windows.h"

#include <X11/Xutil.h>

#include <string_view>

#include "tests/support/window_hints.h"

namespace condyle {
namespace test {

Window window_called(Display* display, Window from, const std::string& title) {
  char* name = nullptr;
  if (XFetchName(display, from, &name) && name) {
    const bool found = std::string_view(name).ends_with(title);
    XFree(name);
    if (found) return from;
  }
  Window root = 0, parent = 0, *children = nullptr, found = 0;
  unsigned count = 0;
  if (!XQueryTree(display, from, &root, &parent, &children, &count)) return 0;
  for (unsigned i = 0; i < count && !found; ++i) found = window_called(display, children[i], title);
  if (children) XFree(children);
  return found;
}

}  // namespace test

std::pair<int, int> min_window_size(const std::string& title) {
  Display* display = XOpenDisplay(nullptr);
  if (!display) return {0, 0};
  XSizeHints hints = {};
  long given = 0;
  std::pair<int, int> least = {0, 0};
  if (const Window window = test::window_called(display, DefaultRootWindow(display), title);
      window != 0 && XGetWMNormalHints(display, window, &hints, &given) &&
      (hints.flags & PMinSize) != 0)
    least = {hints.min_width, hints.min_height};
  XCloseDisplay(display);
  return least;
}

}  // namespace condyle
