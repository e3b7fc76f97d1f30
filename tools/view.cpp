#include <fmt/format.h>

#include <cstdio>

#include "render/window/kept_arrangement.h"
#include "render/window/window.h"
#include "tools/view_session.h"
#include "tools/view_state_file.h"

namespace condyle {
namespace {

/// As the window was left, but for what the command line asks for.
WindowOptions window_options(const ViewOptions& options, const Arrangement& kept) {
  WindowOptions window{.title = "Condyle", .arrangement = kept, .usual_scale = options.ui_scale};
  Arrangement& wanted = window.arrangement;
  window.fit_screen = options.size.empty();
  if (!options.size.empty()) {
    std::tie(wanted.width, wanted.height) = parse_size(options.size);
    wanted.maximized = false;
  }
  if (options.ui_scale) wanted.ui_scale = options.ui_scale;
  if (options.light) wanted.light = *options.light;
  return window;
}

}  // namespace

int run_view(const ViewOptions& options, const CommonOptions& common) {
  KeptArrangement kept;
  Window window(window_options(options, kept.arrangement()));
  kept.begin(window.arrangement());
  if (!kept.trouble().empty()) window.report_error(kept.trouble());
  ViewSession session(window, options, common);
  session.open(options.motion.patient);
  ViewStateFile state(options.state_file);
  while (window.open() || !session.may_close()) {
    session.turn();
    kept.update(window.arrangement());
    state.update(window, session.frame(), session.busy_with());
  }
  kept.update(window.arrangement(), true);
  if (const std::string words = session.stop_recording(); !words.empty())
    fmt::print(stderr, "condyle: {}\n", words);
  return 0;
}

}  // namespace condyle
