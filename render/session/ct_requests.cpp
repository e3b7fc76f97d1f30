#include "render/session/view_session.h"

// The import of a CT in a ViewSession.

namespace condyle {

void ViewSession::show_ct() {
  state_.scene.ct = ct_.view();
  state_.scene.motion = state_.front_end.view().motion;  // the requested motion stays
  state_.front_end.update_scene(state_.scene);
}

void ViewSession::close_ct() {
  if (!ct_.view()) return;
  if (loader_.makes_ct()) loader_.drop();
  ct_.close();
  show_ct();
}

void ViewSession::open_scan(const std::filesystem::path& scan) {
  close_ct();
  ct_.open(scan);
  show_ct();
}

void ViewSession::make_ct_patient(const std::filesystem::path& folder) {
  loader_.make_of_ct(ct_.begin_making(folder));
  show_ct();
}

/// What the background work on the CT has found; and the end of work that made no patient.
void ViewSession::take_ct() {
  if (ct_.making() && !loader_.makes_ct()) {
    ct_.end_making();
    show_ct();
  }
  const std::shared_ptr<const CtView> before = ct_.view();
  state_.try_or_report("Cannot read this scan", [&] { ct_.update(); });
  if (ct_.view() != before) show_ct();
}

}  // namespace condyle
