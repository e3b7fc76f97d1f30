#include <imgui.h>

#include "render/window/window_state.h"

namespace condyle {

void Window::State::take_event(const input_event::Wheel& event) {
  ImGui::GetIO().MouseWheel += static_cast<float>(event.clicks);
  on_wheel(event.clicks);
}

void Window::State::take_event(const input_event::Key& event) {
  const auto& [key, ctrl, shift] = event.key;
  const int mods = (ctrl ? GLFW_MOD_CONTROL : 0) | (shift ? GLFW_MOD_SHIFT : 0);
  if (ImGui::GetIO().WantTextInput) {
    input.keys.push_back({key, true, mods});
    input.keys.push_back({key, false, mods});
  }
  on_key(key, glfwGetKeyScancode(key), mods);
}

void Window::State::take_event(const input_event::Letter& event) {
  if (ImGui::GetIO().WantTextInput) input.keys.push_back({.letter = event.letter});
}

void Window::begin_replay() { state_->input.replayed = true; }
void Window::end_replay() { state_->input.replayed = false; }
bool Window::replaying() const { return state_->input.replayed; }

void Window::handle(const InputEvent& event) {
  State::catch_errors(state_->window, [&](State& state) {
    std::visit([&](const auto& one) { state.take_event(one); }, event);
  });
}

}  // namespace condyle
