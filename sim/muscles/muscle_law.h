#pragma once

#include "sim/case/muscle.h"

namespace condyle {

/// Force laws of a muscle. peck: cosine of the fibre length, force follows excitation without
/// delay, slight damping, no force-velocity relation (Peck 2000, Hannam 2008). hill: with
/// force-velocity relation and activation dynamics. The passive force is the same in both: linear
/// from optimal to maximum length.
enum class MuscleLaw { peck, hill };

struct MuscleLawSettings {
  MuscleLaw law = MuscleLaw::hill;
  double damping_N_s_mm = 0.001;  // along the line of action, both laws
  double fastest_per_s = 10;  // Hill: maximum shortening speed, optimal fibre lengths per second
  double curvature = 0.25;    // Hill: a / F_max of the hyperbola
  double lengthening = 1.4;   // Hill: maximum force when lengthening over isometric force
  double width = 0.45;        // Hill: squared width of the Gaussian force-length relation
  double activate_s = 0.015, deactivate_s = 0.05;  // Hill: time constants
};

/// Tension of a muscle; active_N at full activation. Positive: pulls.
struct MuscleTension {
  double active_N = 0;
  double passive_N = 0;
  double slope_N_s_mm = 0;  // d(total)/d(lengthening speed) at the requested activation
  double at(double activation) const {
    const double sum = activation * active_N + passive_N;
    return sum > 0 ? sum : 0;
  }
};

/// Tension at a length and lengthening speed.
MuscleTension muscle_tension(const Muscle& muscle, const MuscleLawSettings& settings,
                             double activation, double length_mm, double speed_mm_s);

/// Activation after a step of constant excitation; equal to the excitation under the Peck law.
double next_activation(const MuscleLawSettings& settings, double activation, double excitation,
                       double step_s);

}  // namespace condyle
