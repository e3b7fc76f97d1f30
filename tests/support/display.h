#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/picture.h"

namespace condyle {

/// A virtual screen for the life of the object, through the program Xvfb on the first free display
/// number. Sets DISPLAY.
class TestDisplay {
 public:
  explicit TestDisplay(int width = 1280, int height = 720);
  ~TestDisplay();
  TestDisplay(const TestDisplay&) = delete;
  TestDisplay& operator=(const TestDisplay&) = delete;
  bool running() const { return process_ > 0; }
  /// What the screen shows; empty when it cannot be read.
  test::Picture picture() const;

 private:
  std::filesystem::path folder_;  // where Xvfb keeps the screen's pixels
  pid_t process_ = -1;
};

/// Whether a program is found along PATH.
bool has_program(const std::string& name);

/// Real mouse and keyboard events through the program xdotool. Returns whether it succeeded.
bool xdotool(std::vector<std::string> arguments);

}  // namespace condyle
