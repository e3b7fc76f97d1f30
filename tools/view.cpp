#include "render/window/window.h"
#include "tools/view_session.h"
#include "tools/view_state_file.h"

namespace condyle {

int run_view(const ViewOptions& options, const CommonOptions& common) {
  const auto [width, height] = parse_size(options.size);
  Window window({.title = "Condyle",
                 .width = width,
                 .height = height,
                 .ui_scale = options.ui_scale,
                 .light = options.light});
  ViewSession session(window, options, common);
  session.open_patient(options.motion.patient);
  ViewStateFile state(options.state_file);
  while (window.open()) {
    session.turn();
    state.update(window, session.frame(), session.busy_with());
  }
  return 0;
}

}  // namespace condyle
