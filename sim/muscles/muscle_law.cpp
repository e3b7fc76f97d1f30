#include "sim/muscles/muscle_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace condyle {
namespace {

/// Force over isometric force, and its derivative, at fibre speed v in units of the maximum speed
/// (negative: shortening): Hill's hyperbola, continued by a hyperbola of twice the slope at v = 0
/// when lengthening (Katz).
struct SpeedFactor {
  double value = 1, slope = 0;
};
SpeedFactor speed_factor(const MuscleLawSettings& s, double v) {
  const double k = s.curvature;
  if (v <= -1) return {0, 0};
  if (v <= 0) {
    const double below = k - v;
    return {k * (1 + v) / below, k * (k + 1) / (below * below)};
  }
  const double rise = s.lengthening - 1, steep = 2 * (1 + 1 / k);
  const double below = rise + steep * v;
  return {1 + rise * steep * v / below, rise * rise * steep / (below * below)};
}

}  // namespace

MuscleTension muscle_tension(const Muscle& m, const MuscleLawSettings& s, double activation,
                             double length_mm, double speed_mm_s) {
  const double tendon = m.optimal_length_mm * m.tendon_ratio;
  const double fibre = m.optimal_length_mm - tendon;  // optimal
  const double n = (length_mm - tendon) / fibre;
  MuscleTension out;
  const double stretch =
      (length_mm - m.optimal_length_mm) / (m.max_length_mm - m.optimal_length_mm);
  out.passive_N = m.max_force_N * m.passive_fraction * std::clamp(stretch, 0.0, 1.0) +
                  s.damping_N_s_mm * speed_mm_s;
  out.slope_N_s_mm = s.damping_N_s_mm;
  if (s.law == MuscleLaw::peck) {
    if (n > 0.5 && n < 1.5)
      out.active_N = m.max_force_N * 0.5 * (1 + std::cos(2 * std::numbers::pi * n));
    return out;
  }
  const double fastest = s.fastest_per_s * fibre;
  const SpeedFactor speed = speed_factor(s, speed_mm_s / fastest);
  const double isometric = m.max_force_N * std::exp(-(n - 1) * (n - 1) / s.width);
  out.active_N = isometric * speed.value;
  out.slope_N_s_mm += activation * isometric * speed.slope / fastest;
  return out;
}

double next_activation(const MuscleLawSettings& s, double activation, double excitation,
                       double step_s) {
  if (s.law == MuscleLaw::peck) return excitation;
  const double delay = excitation > activation ? s.activate_s : s.deactivate_s;
  return excitation + (activation - excitation) * std::exp(-step_s / delay);
}

}  // namespace condyle
