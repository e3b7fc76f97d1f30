#include "render/window/window.h"
#include "tools/view_session.h"

namespace condyle {

int run_view(const ViewOptions& options, const CommonOptions& common) {
  Window window({.title = "Condyle", .ui_scale = options.ui_scale, .light = options.light});
  ViewSession session(window, options, common);
  session.open_patient(options.motion.patient);
  while (window.open()) session.turn();
  return 0;
}

}  // namespace condyle
