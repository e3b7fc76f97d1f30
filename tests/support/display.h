#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace condyle {

/// A virtual screen of 1280x720 for the life of the object, through the program Xvfb on the first
/// free display number. Sets DISPLAY.
class TestDisplay {
 public:
  TestDisplay();
  ~TestDisplay();
  TestDisplay(const TestDisplay&) = delete;
  TestDisplay& operator=(const TestDisplay&) = delete;
  bool running() const { return process_ > 0; }

 private:
  pid_t process_ = -1;
};

/// Whether a program is found along PATH.
bool has_program(const std::string& name);

/// Real mouse and keyboard events through the program xdotool. gives: whether it succeeded.
bool xdotool(std::vector<std::string> arguments);

}  // namespace condyle
