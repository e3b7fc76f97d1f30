#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "render/window/window_state.h"

namespace condyle {
namespace {

constexpr double idle_wait_s = 0.25;
constexpr double attentive_s = 0.5;  // after an event, results may arrive without wake()

/// The key by the letter or sign that is printed on it, regardless of the layout.
int printed_key(int key, int scancode) {
  const char* name = glfwGetKeyName(key, scancode);
  if (!name || name[0] == 0 || name[1] != 0) return key;
  if (name[0] >= 'a' && name[0] <= 'z') return GLFW_KEY_A + (name[0] - 'a');
  if (name[0] == '+' || name[0] == '=') return GLFW_KEY_EQUAL;
  return name[0] == '-' ? GLFW_KEY_MINUS : key;
}

}  // namespace

void Window::State::install_callbacks() {
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
    catch_user(w, [&](State& s) { s.on_button(button, action == GLFW_PRESS, mods); });
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    catch_user(w, [&](State& s) { s.on_move(x, y); });
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double clicks) {
    catch_user(w, [&](State& s) { s.on_wheel(clicks); });
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) {
    catch_errors(w, [](State& s) {
      s.pacing.scene_changed = true;
      s.note_size();
    });
  });
  glfwSetWindowMaximizeCallback(
      window, [](GLFWwindow* w, int) { catch_errors(w, [](State& s) { s.note_size(); }); });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    catch_errors(
        w, [&](State& s) { s.input.dropped.insert(s.input.dropped.end(), paths, paths + count); });
  });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { catch_errors(w, [](State&) {}); });
  glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int) { catch_errors(w, [](State&) {}); });
}

/// Replaces ImGui's callbacks: keys and letters are queued together, each for its own pass over the
/// panels, so that their order is preserved.
void Window::State::install_key_callbacks() {
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int scancode, int action, int mods) {
    catch_user(w, [&](State& s) {
      if (action != GLFW_REPEAT && key >= 0 && key <= GLFW_KEY_LAST &&
          (action == GLFW_RELEASE || ImGui::GetIO().WantTextInput))
        s.input.keys.push_back({key, action == GLFW_PRESS, mods});
    });
    if (action == GLFW_RELEASE) return;
    catch_errors(w, [&](State& s) {
      if (!s.input.replayed) return s.on_key(printed_key(key, scancode), mods);
      if (key == GLFW_KEY_ESCAPE) s.end_replay();
    });
  });
  glfwSetCharCallback(window, [](GLFWwindow* w, unsigned letter) {
    catch_user(w, [&](State& s) {
      if (ImGui::GetIO().WantTextInput) s.input.keys.push_back({.letter = letter});
    });
  });
}

void Window::State::on_key(int key, int mods) {
  // Keys typed into a field are not commands; Esc, the F keys and Ctrl+Q are.
  const bool command_anyway = key == GLFW_KEY_ESCAPE ||
                              (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12) ||
                              (key == GLFW_KEY_Q && (mods & GLFW_MOD_CONTROL) != 0);
  if (ImGui::GetIO().WantTextInput && !command_anyway) return;
  if (mods == 0 && choose_axis(key)) return;
  const auto command = command_of({.key = key,
                                   .shift = (mods & GLFW_MOD_SHIFT) != 0,
                                   .ctrl = (mods & (GLFW_MOD_CONTROL | GLFW_MOD_SUPER)) != 0});
  if (command && panels->takes(*command))
    run(*command);
  else if (command)
    panels->refuse_key();
}

bool Window::State::over_view(double x, double y) const {
  if (scene.ct || panels->dialog_open() || !view_rect().contains(x, y)) return false;
  // The cube floats on the view.
  return std::none_of(panels->items().begin(), panels->items().end(), [&](const DrawnItem& item) {
    return item.panel.empty() && item.rect.contains(x, y);
  });
}

void Window::State::on_button(int button, bool down, int mods) {
  input.mouse.pressed(button, down, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0);
  const MouseMoment& now = input.mouse.now();
  if (down && mods == 0 && over_view(now.x, now.y)) input.clicks.press(button, {now.x, now.y});
  if (down && button == GLFW_MOUSE_BUTTON_LEFT && mods == 0 && over_view(now.x, now.y) &&
      (grip_handle({now.x, now.y}) || grip_body({now.x, now.y}) || set_point({now.x, now.y})))
    return;
  if (!down && button == GLFW_MOUSE_BUTTON_LEFT && view.held_handle) {
    input.clicks = {};
    return release_handle();
  }
  if (!down && button == GLFW_MOUSE_BUTTON_LEFT) input.held.reset();
  if (!down)
    if (const auto click = input.clicks.release(button, {now.x, now.y}, glfwGetTime()))
      on_click(*click);
  if (down && input.drag == CameraDrag::none && !input.held && over_view(now.x, now.y)) {
    input.drag = drag_of({.left = button == GLFW_MOUSE_BUTTON_LEFT,
                          .middle = button == GLFW_MOUSE_BUTTON_MIDDLE,
                          .right = button == GLFW_MOUSE_BUTTON_RIGHT,
                          .shift = (mods & GLFW_MOD_SHIFT) != 0,
                          .ctrl = (mods & GLFW_MOD_CONTROL) != 0});
    input.drag_button = button;
  } else if (!down && button == input.drag_button) {
    input.drag = CameraDrag::none;
    input.drag_button = -1;
  }
}

void Window::State::on_move(double x, double y) {
  const MouseMoment before = input.mouse.now();
  input.mouse.moved(x, y);
  input.clicks.moved({x, y});
  if (view.held_handle) return move_handle({x, y});
  if (input.held) return move_body({x, y});
  if (input.drag == CameraDrag::none) return;
  camera = dragged(camera, input.drag, {before.x, before.y}, {x, y}, view_rect(), zoom);
  pacing.scene_changed = true;
  pacing.last_change = Clock::now();
}

void Window::State::on_wheel(double clicks) {
  const MouseMoment& now = input.mouse.now();
  if (!over_view(now.x, now.y)) return;
  camera = wheeled(camera, clicks, {now.x, now.y}, view_rect(), zoom);
  pacing.scene_changed = true;
  pacing.last_change = Clock::now();
}

void Window::State::run(Command command) {
  if (panels->run(command, scene, view)) return;
  switch (command) {
    case Command::quit:
      glfwSetWindowShouldClose(window, GLFW_TRUE);
      break;
    case Command::keep_state:
      comparison.frame = render_request.frame;
      comparison.by_hand = comparison.frame != nullptr;
      comparison.before.reset();
      comparison.values = render_request.values;
      pacing.scene_changed = true;
      break;
    case Command::focus_selected:
      if (view.selected) focus(*view.selected);
      break;
    case Command::toggle_theme:
      arrangement.light = !arrangement.light;
      break;
    case Command::larger_panels:
    case Command::smaller_panels:
    case Command::default_panels:
      scale_panels(command);
      break;
    case Command::window_picture:
      save_window = true;
      break;
    case Command::picture:
      if (render_request.parts) request_picture();
      render_thread->save_picture(options.picture_folder);
      break;
    default:
      set_standard_view(camera_of(command));
  }
}

/// A maximized window keeps the size to restore.
void Window::State::note_size() {
  arrangement.maximized = glfwGetWindowAttrib(window, GLFW_MAXIMIZED) == GLFW_TRUE;
  if (arrangement.maximized || glfwGetWindowAttrib(window, GLFW_ICONIFIED) == GLFW_TRUE) return;
  const auto [w, h] = size();
  const double screen = screen_scale();  // GLFW enlarges a new window by this factor
  arrangement.width = static_cast<int>(std::lround(w / screen));
  arrangement.height = static_cast<int>(std::lround(h / screen));
}

void Window::State::set_standard_view(std::string_view name) {
  if (!render_request.parts || name.empty()) return;
  const ViewRect rect = view_rect();
  Eigen::AlignedBox3d in_room = box;
  if (view.hands.at(cranium_body)) {
    const Pose X_RC = view.hands.X_RC(frame() ? frame()->poses[view.hands.jaw] : Pose{});
    for (int corner = 0; corner < 8; ++corner)
      in_room.extend(X_RC * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  const Eigen::Vector3d low = in_room.min(), high = in_room.max();
  camera = standard_camera(std::string(name), low, high, rect.width / rect.height);
  const double size = std::max(1.0, (high - low).norm());
  zoom = {.nearest_mm = 0.05 * size, .farthest_mm = 12 * size};
  pacing.scene_changed = true;
}

void Window::State::wait_for_events() {
  const bool active = moving() || pacing.frames_due > 0 || pacing.scene_changed;
  const double wait =
      active ? picture_interval_s - seconds_since(pacing.last_look)
             : (seconds_since(pacing.last_event) < attentive_s ? picture_interval_s : idle_wait_s);
  pacing.note_time_away();
  if (wait > 0) {
    glfwWaitEventsTimeout(wait);
  } else {
    glfwPollEvents();
  }
  pacing.note_look();
  // Each press and release gets its own pass over the panels, so that none is lost between
  // pictures.
  while (input.waits()) interface_frame();
}

}  // namespace condyle
