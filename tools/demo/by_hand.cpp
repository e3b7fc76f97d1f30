#include <fmt/format.h>

#include "engine/core/files.h"
#include "render/session/view_session.h"
#include "render/window/input_replay.h"
#include "tools/common.h"
#include "tools/demo/by_hand_steps.h"
#include "tools/demo/demo.h"
#include "tools/motion_options.h"

namespace condyle {
namespace {

std::string with_folder(std::string text, const std::filesystem::path& folder) {
  const std::string variable = "{out}";
  const std::string name = folder.string();
  for (auto at = text.find(variable); at != std::string::npos;
       at = text.find(variable, at + name.size()))
    text.replace(at, variable.size(), name);
  return text;
}

}  // namespace

int run_by_hand(const DemoOptions& options, const CommonOptions& common) {
  const std::filesystem::path out = std::filesystem::absolute(options.out).lexically_normal();
  make_folder(out);
  const std::string text = with_folder(by_hand_steps, out);
  write_file(out / "steps.txt", text);

  Window window({.title = "Condyle", .picture_folder = out, .recording_folder = out});
  SessionSettings settings{.first_motion = "rest", .keeps_files = false};
  settings.simulator = simulator_settings({}, common);
  ViewSession session(window, settings);
  session.begin(by_hand_patient);
  if (common.prints_summary())
    fmt::print(stderr, "planning in the window; Esc ends the replay and gives the window to you\n");
  InputReplay replay(window, parse_input_steps(text, "the list of steps"), out);
  for (bool replaying = true; window.open();) {
    session.turn();
    const bool busy = session.frame() == nullptr || !session.busy_with().empty();
    if (replaying && !replay.turn(busy)) {
      replaying = false;
      if (replay.done()) window.close();
    }
  }
  if (replay.done() && common.prints_summary())
    fmt::print(stderr, "{}: plan.json, splints and pictures of the window\n", out.string());
  return 0;
}

}  // namespace condyle
