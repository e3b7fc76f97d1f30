#pragma once

#include "render/window/view/view_state.h"

namespace condyle {

/// Maximum lead of the clock over the last simulated frame for a loop period of `loop_s`: the steps
/// in progress. So a slow simulation slows the playback instead of skipping steps; slow pictures do
/// not.
double allowed_lead_s(double loop_s);

/// Advances the playing clock by `elapsed_s` of real time since the last call. At the end it starts
/// over, or stops if `loop` is off. `shown_s` is the time of the last simulated
/// frame.
void advance_clock(ViewState& view, double elapsed_s, double duration_s, double shown_s);

/// Starts or stops playing; starting at the end restarts, and releases a held
/// opening or jaw, which is at X_CM.
void toggle_playing(ViewState& view, double duration_s, const Pose& X_CM);

/// Moves the stopped clock by `delta_s`, within the motion.
void step_clock(ViewState& view, double delta_s, double duration_s, const Pose& X_CM);

/// Sets the clock to a time of the motion, and releases a held opening or jaw.
void seek(ViewState& view, double time_s, double duration_s, const Pose& X_CM);

}  // namespace condyle
