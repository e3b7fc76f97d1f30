#include "render/window/picture/quality.h"

#include <algorithm>
#include <array>

namespace condyle {
namespace {

constexpr double target_ms = 33;  // 30 pictures a second

// In order of decreasing quality. Without a GPU multisampling costs most, then triangles, then the
// shadow map, then pixels.
constexpr std::array<Quality, 7> levels = {{
    {.render_scale = 1, .samples = 4, .shadows = true},
    {.render_scale = 1, .samples = 1, .shadows = true},
    {.render_scale = 1, .samples = 1, .shadows = true, .coarse = true},
    {.render_scale = 1, .samples = 1, .shadows = false, .coarse = true},
    {.render_scale = 0.8, .samples = 1, .shadows = false, .coarse = true},
    {.render_scale = 0.66, .samples = 1, .shadows = false, .coarse = true},
    {.render_scale = 0.4, .samples = 1, .shadows = false, .coarse = true},
}};

// The last level is for a large window without a GPU, below 15 pictures a second.
constexpr int last = static_cast<int>(levels.size()) - 1;
constexpr double standstill_ms = 1000.0 / 15;

// Steps per second below which the simulation gets the pictures' time, and above which it does not.
constexpr double few_steps = 60, many_steps = 90;

}  // namespace

Quality QualityGovernor::choose(bool moving) const {
  return moving ? levels[static_cast<std::size_t>(level_)] : levels[0];
}

void QualityGovernor::measured(bool moving, double picture_ms) {
  if (!moving) {
    // The first picture at rest already measures the speed of the machine.
    if (!known_ && picture_ms > 3 * target_ms) level_ = 3;
    known_ = true;
    return;
  }
  known_ = true;
  // Down at once when far too slow, up only after many fast pictures, to avoid flicker.
  const double limit_ms = level_ + 1 < last ? target_ms : standstill_ms;
  slow_ = picture_ms > limit_ms ? slow_ + 1 : 0;
  fast_ = picture_ms < 0.3 * target_ms ? fast_ + 1 : 0;
  if (slow_ >= 3 || picture_ms > 3 * limit_ms) {
    level_ = std::min(level_ + 1, last);
    slow_ = 0;
  } else if (fast_ >= 60) {
    level_ = std::max(level_ - 1, 0);
    fast_ = 0;
  }
}

void QualityGovernor::simulated(double steps_per_second) {
  if (steps_per_second <= 0) return;  // none yet
  if (steps_per_second < few_steps) yields_ = true;
  if (steps_per_second > many_steps) yields_ = false;
}

}  // namespace condyle
