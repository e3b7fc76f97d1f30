#include "render/window/glfw_session.h"

#include <GLFW/glfw3.h>

#include <cstdlib>

#include "engine/core/error.h"

namespace condyle {
namespace {

constexpr const char* instead =
    " Pictures and films need no display: condyle record --motion opening --out DIR";

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value;
}

}  // namespace

std::string take_glfw_error() {
  const char* words = nullptr;
  return glfwGetError(&words) == GLFW_NO_ERROR || !words ? std::string() : std::string(words);
}

GlfwSession::GlfwSession() {
  // Asked before GLFW is: its own error does not distinguish a missing display from a broken one.
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY"))
    throw MachineError(
        std::string("no display was found: DISPLAY is not set, so no window can be opened.") +
        instead);
  if (!glfwInit()) {
    const std::string words = take_glfw_error();
    throw MachineError("no display was found: DISPLAY is '" +
                       std::string(is_set("DISPLAY") ? std::getenv("DISPLAY") : "") +
                       "' and does not answer" + (words.empty() ? "" : " (" + words + ")") + "." +
                       instead);
  }
}

GlfwSession::~GlfwSession() { glfwTerminate(); }

}  // namespace condyle
