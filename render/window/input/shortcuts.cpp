#include "render/window/input/shortcuts.h"

#include <GLFW/glfw3.h>

#include <array>

namespace condyle {
namespace {

// A key, the same key with Shift. The few keys with Ctrl are separate.
struct Binding {
  int key;
  Command plain, shifted;
};
constexpr std::array bindings = {
    Binding{GLFW_KEY_SPACE, Command::toggle_play, Command::toggle_play},
    Binding{GLFW_KEY_LEFT, Command::step_back, Command::jump_back},
    Binding{GLFW_KEY_RIGHT, Command::step_forward, Command::jump_forward},
    Binding{GLFW_KEY_KP_1, Command::view_front, Command::view_back},
    Binding{GLFW_KEY_KP_3, Command::view_left, Command::view_right},
    Binding{GLFW_KEY_KP_7, Command::view_above, Command::view_below},
    Binding{GLFW_KEY_KP_0, Command::reset_view, Command::reset_view},
    Binding{GLFW_KEY_1, Command::view_front, Command::view_back},
    Binding{GLFW_KEY_3, Command::view_left, Command::view_right},
    Binding{GLFW_KEY_7, Command::view_above, Command::view_below},
    Binding{GLFW_KEY_0, Command::reset_view, Command::reset_view},
    Binding{GLFW_KEY_HOME, Command::reset_view, Command::reset_view},
    Binding{GLFW_KEY_A, Command::view_front, Command::view_back},
    Binding{GLFW_KEY_P, Command::view_back, Command::view_front},
    Binding{GLFW_KEY_L, Command::view_left, Command::view_right},
    Binding{GLFW_KEY_R, Command::view_right, Command::view_left},
    Binding{GLFW_KEY_S, Command::view_above, Command::view_below},
    Binding{GLFW_KEY_I, Command::view_below, Command::view_above},
    Binding{GLFW_KEY_K, Command::toggle_skin, Command::toggle_skin},
    Binding{GLFW_KEY_D, Command::toggle_distances, Command::toggle_distances},
    Binding{GLFW_KEY_F, Command::focus_selected, Command::focus_selected},
    Binding{GLFW_KEY_M, Command::toggle_move, Command::toggle_measure},
    Binding{GLFW_KEY_C, Command::toggle_cut, Command::toggle_cut},
    Binding{GLFW_KEY_N, Command::toggle_measure, Command::toggle_measure},
    Binding{GLFW_KEY_B, Command::toggle_landmarks, Command::toggle_landmarks},
    Binding{GLFW_KEY_G, Command::toggle_plots, Command::toggle_plots},
    Binding{GLFW_KEY_T, Command::toggle_theme, Command::toggle_theme},
    Binding{GLFW_KEY_TAB, Command::toggle_panels, Command::toggle_panels},
    Binding{GLFW_KEY_F12, Command::picture, Command::window_picture},
    Binding{GLFW_KEY_F1, Command::help, Command::help},
    Binding{GLFW_KEY_ESCAPE, Command::close_dialog, Command::close_dialog},
    Binding{GLFW_KEY_ENTER, Command::accept, Command::accept},
    Binding{GLFW_KEY_KP_ENTER, Command::accept, Command::accept},
};

constexpr std::array mouse_lines = {
    HelpLine{"left drag", "turn around the patient"},
    HelpLine{"middle drag, Shift+left", "move the picture"},
    HelpLine{"wheel, right drag", "nearer, farther"},
    HelpLine{"Ctrl+left", "roll the picture"},
    HelpLine{"click, double click", "select a part, focus it (F)"},
    HelpLine{"right click a part", "hide, glass, measure, cut, move"},
    HelpLine{"Ctrl+click a slider", "type its number"},
};
constexpr std::array view_lines = {
    HelpLine{"A P L R S I", "front, back, left, right, above, below"},
    HelpLine{"keypad 1 3 7", "front, left, above"},
    HelpLine{"Shift with these", "the opposite side"},
    HelpLine{"0, Home", "first view"},
};
constexpr std::array play_lines = {
    HelpLine{"Space", "play, pause"},
    HelpLine{"left, right", "a step back, forward"},
    HelpLine{"Shift+left, right", "ten steps"},
};
constexpr std::array move_lines = {
    HelpLine{"M", "move bones, on and off"},
    HelpLine{"drag a bone", "move it; it slides on contact"},
    HelpLine{"drag an arrow, a ring", "along or about one axis"},
    HelpLine{"X Y Z while dragging", "left, back or up alone"},
    HelpLine{"Ctrl while dragging", "steps of 0.5 mm and 1\u00b0"},
    HelpLine{"Release, in its panel", "joints and muscles, or bone, move it"},
};
constexpr std::array window_lines = {
    HelpLine{"Ctrl+Z, Ctrl+Y", "undo, redo: settings and moves"},
    HelpLine{"Ctrl+O", "open a session, patient or motion"},
    HelpLine{"Ctrl+S", "save the session; Shift: elsewhere"},
    HelpLine{"Tab", "panels on, off"},
    HelpLine{"T", "dark or light panels and view"},
    HelpLine{"Ctrl+=  -  0", "larger, smaller, default panels"},
    HelpLine{"F12", "save the picture as PNG"},
    HelpLine{"Shift+F12", "save the whole window"},
    HelpLine{"F1, Esc", "this help; close a dialog"},
    HelpLine{"Ctrl+Q", "quit"},
};
constexpr std::array show_lines = {
    HelpLine{"K", "skin on, off"},
    HelpLine{"D", "distances on, off"},
    HelpLine{"N, Shift+M", "measure: click points"},
    HelpLine{"C", "draw a cut: click points, Enter"},
    HelpLine{"B", "landmarks: choose, click"},
    HelpLine{"G", "plots on, off"},
};
constexpr std::array groups = {
    HelpGroup{"Mouse", mouse_lines},   HelpGroup{"Views", view_lines},
    HelpGroup{"Motion", play_lines},   HelpGroup{"Moving bones", move_lines},
    HelpGroup{"Window", window_lines}, HelpGroup{"Showing and measuring", show_lines},
};

}  // namespace

std::optional<Command> command_of(const KeyPress& press) {
  if (press.ctrl) {
    if (press.key == GLFW_KEY_Q) return Command::quit;
    if (press.key == GLFW_KEY_O) return Command::open_files;
    if (press.key == GLFW_KEY_S)
      return press.shift ? Command::save_session_as : Command::save_session;
    if (press.key == GLFW_KEY_Y || (press.key == GLFW_KEY_Z && press.shift)) return Command::redo;
    if (press.key == GLFW_KEY_Z) return Command::undo;
    if (press.key == GLFW_KEY_EQUAL || press.key == GLFW_KEY_KP_ADD) return Command::larger_panels;
    if (press.key == GLFW_KEY_MINUS || press.key == GLFW_KEY_KP_SUBTRACT)
      return Command::smaller_panels;
    if (press.key == GLFW_KEY_0 || press.key == GLFW_KEY_KP_0) return Command::default_panels;
    return std::nullopt;
  }
  for (const Binding& binding : bindings)
    if (binding.key == press.key) return press.shift ? binding.shifted : binding.plain;
  return std::nullopt;
}

std::string_view camera_of(Command command) {
  switch (command) {
    case Command::view_front:
      return "front";
    case Command::view_back:
      return "back";
    case Command::view_left:
      return "left";
    case Command::view_right:
      return "right";
    case Command::view_above:
      return "above";
    case Command::view_below:
      return "below";
    case Command::reset_view:
      return "three-quarter";
    default:
      return {};
  }
}

std::span<const HelpGroup> help_groups() { return groups; }

}  // namespace condyle
