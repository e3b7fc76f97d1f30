#include "render/window/view/playback.h"

#include <algorithm>
#include <cmath>

namespace condyle {

double allowed_lead_s(double loop_s) { return std::clamp(1.0 / 30 + 2 * loop_s, 0.05, 0.2); }

void advance_clock(ViewState& view, double elapsed_s, double duration_s, double shown_s) {
  if (!view.playing || duration_s <= 0) return;
  double lead = view.time_s - shown_s;
  // The shorter direction around the loop: the clock may have wrapped while the frame has not yet.
  if (view.loop) lead = std::remainder(lead, duration_s);
  const double step = std::max(0.0, elapsed_s) * view.speed;
  view.time_s +=
      std::clamp(std::min(0.2, allowed_lead_s(elapsed_s) * view.speed) - lead, 0.0, step);
  if (view.time_s < duration_s) return;
  if (view.loop) {
    view.time_s = std::fmod(view.time_s, duration_s);
  } else {
    view.time_s = duration_s;
    view.playing = false;
  }
}

void toggle_playing(ViewState& view, double duration_s, const Pose& X_CM) {
  if (duration_s <= 0) return;
  view.playing = !view.playing;
  if (!view.playing) return;
  view.opening_mm.reset();
  view.hands.release_jaw(X_CM);
  if (view.time_s >= duration_s) view.time_s = 0;
}

void step_clock(ViewState& view, double delta_s, double duration_s, const Pose& X_CM) {
  view.playing = false;
  seek(view, view.time_s + delta_s, duration_s, X_CM);
}

void seek(ViewState& view, double time_s, double duration_s, const Pose& X_CM) {
  view.opening_mm.reset();
  view.hands.release_jaw(X_CM);
  view.time_s = std::clamp(time_s, 0.0, std::max(0.0, duration_s));
}

}  // namespace condyle
