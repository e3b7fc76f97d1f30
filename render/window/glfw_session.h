#pragma once

#include <string>

namespace condyle {

/// Lifetime of GLFW, with its errors as sentences.
class GlfwSession {
 public:
  /// throws: MachineError when there is no display.
  GlfwSession();
  ~GlfwSession();
  GlfwSession(const GlfwSession&) = delete;
  GlfwSession& operator=(const GlfwSession&) = delete;
};

/// Returns and clears GLFW's last error; empty if there was none.
std::string take_glfw_error();

}  // namespace condyle
