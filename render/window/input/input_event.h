#pragma once

#include <variant>

#include "render/window/input/input_steps.h"

namespace condyle {

/// Input that does not come from the user's own mouse and keyboard, but is handled as if it did.
namespace input_event {
struct Pointer {
  double x = 0, y = 0;  // pixels from the top left
};
struct Button {
  int button = 0;  // as GLFW numbers it
  bool down = false;
};
struct Wheel {
  double clicks = 0;  // up is positive
};
/// Pressed and released.
struct Key {
  NamedKey key;
};
/// Typed into a field.
struct Letter {
  unsigned letter = 0;
};
}  // namespace input_event

using InputEvent = std::variant<input_event::Pointer, input_event::Button, input_event::Wheel,
                                input_event::Key, input_event::Letter>;

}  // namespace condyle
