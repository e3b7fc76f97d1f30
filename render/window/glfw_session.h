#pragma once

#include <string>

namespace condyle {

/// GLFW from start to end, with its errors as sentences.
class GlfwSession {
 public:
  /// throws: MachineError when there is no display.
  GlfwSession();
  ~GlfwSession();
  GlfwSession(const GlfwSession&) = delete;
  GlfwSession& operator=(const GlfwSession&) = delete;
};

/// What GLFW last complained about, and forgets it; empty when all is well.
std::string take_glfw_error();

}  // namespace condyle
