#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "engine/core/error.h"
#include "render/session/saved/session_file.h"
#include "render/session/view_session.h"
#include "render/window/settings/kept_arrangement.h"
#include "render/window/view_state_file.h"
#include "render/window/window.h"
#include "sim/session/patient_files.h"
#include "sim/session/videos_folder.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/motion_options.h"

namespace condyle {
namespace {

struct ViewOptions {
  MotionOptions motion;
  std::optional<double> ui_scale = {};  // none: as the window was left, at first by the screen
  std::optional<bool> light = {};       // none: as the window was left
  std::string size = {};                // "1280x720"; empty: as the window was left
  std::filesystem::path state_file;     // kept up to date with what the window shows; empty: none
};

/// The stored arrangement of the window, overridden by the command line.
WindowOptions window_options(const ViewOptions& options, const Arrangement& kept) {
  const VideosFolder videos = videos_folder();
  WindowOptions window{.title = "Condyle",
                       .arrangement = kept,
                       .default_scale = options.ui_scale,
                       .recording_folder = videos.folder,
                       .recording_folder_name = videos.what,
                       .file_dialog = !FileDialog::program().empty()};
  Arrangement& start = window.arrangement;
  window.fit_screen = options.size.empty();
  if (!options.size.empty()) {
    std::tie(start.width, start.height) = parse_size(options.size);
    start.maximized = false;
  }
  if (options.ui_scale) start.ui_scale = options.ui_scale;
  if (options.light) start.light = *options.light;
  return window;
}

SessionSettings session_settings(const MotionOptions& options, const CommonOptions& common) {
  SessionSettings settings{.motion = options.settings,
                           .muscles = options.muscles,
                           .plan = options.plan,
                           .respect_contact = options.respect_contact,
                           .simulator = simulator_settings(options, common)};
  if (!options.motion.empty()) settings.first_motion = options.motion;
  return settings;
}

/// The path to open. throws: InputError for a session that cannot be opened, before there is a
/// window.
std::filesystem::path path_to_open(const MotionOptions& options) {
  const std::filesystem::path file = options.patient;
  std::error_code ignored;
  if (kind_of(file) != FileKind::session) return case_of(options);
  check_session_files(load_session(file), file);
  if (!options.motion.empty()) throw InputError("--motion: " + file.string() + " has a motion");
  if (!options.plan.empty()) throw InputError("--plan: " + file.string() + " has its plan");
  return file;
}

int run_view(const ViewOptions& options, const CommonOptions& common) {
  const std::filesystem::path path = path_to_open(options.motion);
  KeptArrangement kept;
  Window window(window_options(options, kept.arrangement()));
  kept.begin(window.arrangement());
  if (!kept.trouble().empty())
    window.report_error("Cannot restore the window as it was left", kept.trouble());
  ViewSession session(window, session_settings(options.motion, common));
  session.begin(path);
  ViewStateFile state(options.state_file);
  while (window.open() || !session.may_close()) {
    session.turn();
    kept.update(window.arrangement());
    state.update(window, session.frame(), session.busy_with());
  }
  kept.update(window.arrangement(), true);
  session.end();
  if (const std::string words = session.stop_recording(); !words.empty())
    fmt::print(stderr, "condyle: {}\n", words);
  return 0;
}

}  // namespace

void add_view(Commands& commands) {
  const auto options = std::make_shared<ViewOptions>();
  CLI::App& command =
      commands.add("view", "Open the window", "condyle view mycase --motion opening",
                   [options](const CommonOptions& common) { return run_view(*options, common); });
  add_motion(command, options->motion);
  command.get_option("CASE")->description(
      "Folder with case.json, or of loose surfaces, whose roles the window asks, or a session that "
      "the window has saved (default: the built-in patient)");
  begin_group(command, "Window");
  in_range(command.add_option("--ui-scale", options->ui_scale,
                              "Size of the panels; default as they were left, at first by the "
                              "screen"),
           0.5, 4);
  command
      .add_option("--size", options->size,
                  "Size of the window; default as it was left, at first 1280x720")
      ->type_name("WIDTHxHEIGHT");
  command
      .add_option("--state-file", options->state_file,
                  "Keep a JSON file up to date with what the window shows, for programs that use "
                  "the window")
      ->type_name("FILE");
  command.add_flag_callback(
      "--light", [options] { options->light = true; },
      "Light panels and picture; default as they were left, at first dark (key T)");
  command.add_flag_callback(
      "--dark", [options] { options->light = false; }, "Dark panels and picture");
  add_pairs(command, options->motion);
  add_sliding(command, options->motion);
  add_tissue(command, options->motion.tissue);
  add_motion_details(command, options->motion);
}

}  // namespace condyle
