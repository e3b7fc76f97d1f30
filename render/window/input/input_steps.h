#pragma once

#include <string>
#include <vector>

namespace condyle {

/// A step of a list of inputs: what a person does with the mouse or the keyboard, or waits for.
struct InputStep {
  enum class Kind {
    say,      // shows `words` at the foot of the window
    click,    // the middle of `item`
    choose,   // the entry `words` of the list `item`: clicks both
    enter,    // replaces the text of the field `item` by `words`
    drag,     // from `item`, by `right` and `down`
    wheel,    // turns the wheel by `down` clicks over `item`, negative is up
    key,      // presses `words`: "m", "ctrl+z", "Return"
    wait,     // until `item` is in the window and no background work runs
    picture,  // saves the window as `words`.png
  };

  Kind kind = Kind::wait;
  std::string item = {};       // of the window, see DrawnItem
  std::string words = {};      // texts may contain spaces
  double right = 0, down = 0;  // pixels, or clicks of the wheel
  int line = 0;                // in the list, from 1
};

/// Reads a list of inputs, one step a line:
///
///     say Cut the upper jaw
///     choose plan-osteotomy le_fort_1
///     wait plan-step:1
///     enter plan-number:forward_mm 4
///     drag handle:P 0 -30
///     wheel plan-undo -5
///     key ctrl+z
///     picture planned
///
/// Blank lines and lines that begin with "#" are comments. `name`: of the list, for messages.
/// throws: InputError naming the line and the word.
std::vector<InputStep> parse_input_steps(const std::string& text, const std::string& name);

/// The letters of a text in UTF-8, as Unicode numbers them; a damaged one is U+FFFD.
std::vector<unsigned> letters_of(const std::string& utf8);

/// A key with its modifiers.
struct NamedKey {
  int key = 0;  // as GLFW numbers it
  bool ctrl = false, shift = false;
};
/// The key called "m", "5", "Return", "Escape", "F12", ..., after "ctrl+" and "shift+". throws:
/// InputError for another name.
NamedKey named_key(const std::string& name);

}  // namespace condyle
