#include <imgui.h>

#include "render/window/window_state.h"

namespace condyle {

void Window::State::take_event(const input_event::Wheel& event) {
  input.replayed_wheel += static_cast<float>(event.clicks);
  on_wheel(event.clicks);
}

void Window::State::take_event(const input_event::Key& event) {
  const auto& [key, ctrl, shift] = event.key;
  const int mods = (ctrl ? GLFW_MOD_CONTROL : 0) | (shift ? GLFW_MOD_SHIFT : 0);
  if (ImGui::GetIO().WantTextInput) {
    input.keys.push_back({key, true, mods});
    input.keys.push_back({key, false, 0});
  }
  on_key(key, mods);
}

void Window::State::take_event(const input_event::Letter& event) {
  if (ImGui::GetIO().WantTextInput) input.keys.push_back({.letter = event.letter});
}

/// What a replay holds is released.
void Window::State::end_replay() {
  if (!input.replayed) return;
  const auto down = input.mouse.now().down;
  for (std::size_t button = 0; button < down.size(); ++button)
    if (down[button]) on_button(static_cast<int>(button), false, 0);
  input.replayed = false;
}

void Window::begin_replay() { state_->input.replayed = true; }
void Window::end_replay() { state_->end_replay(); }
bool Window::replaying() const { return state_->input.replayed; }

void Window::handle(const InputEvent& event) {
  State::catch_errors(state_->window, [&](State& state) {
    std::visit([&](const auto& one) { state.take_event(one); }, event);
  });
}

}  // namespace condyle
