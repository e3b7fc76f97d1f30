#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace condyle {

/// Command of a key or a button.
enum class Command {
  toggle_play,
  step_back,
  step_forward,
  jump_back,
  jump_forward,
  view_front,
  view_back,
  view_left,
  view_right,
  view_above,
  view_below,
  reset_view,
  picture,
  window_picture,
  toggle_skin,
  toggle_distances,
  toggle_panels,
  toggle_theme,
  larger_panels,
  smaller_panels,
  default_panels,
  focus_selected,
  toggle_move,
  toggle_cut,
  toggle_measure,
  toggle_landmarks,
  toggle_plots,
  open_files,
  save_session,     // in its file, if there is one
  save_session_as,  // in a file to be named
  keep_state,
  undo,
  redo,
  help,
  close_dialog,
  accept,  // accepts and closes a box
  quit
};

/// Keys by their GLFW numbers, so that this module does not depend on GLFW.
struct KeyPress {
  int key = 0;
  bool shift = false, ctrl = false;
};
std::optional<Command> command_of(const KeyPress& press);

/// Name of the camera (render/camera/camera.h) of a view command; empty for other commands.
std::string_view camera_of(Command command);

/// The lines of the help: keys and mouse actions with their effects.
struct HelpLine {
  std::string_view keys, meaning;
};
struct HelpGroup {
  std::string_view title;
  std::span<const HelpLine> lines;
};
std::span<const HelpGroup> help_groups();

}  // namespace condyle
