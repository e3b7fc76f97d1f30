#pragma once

#include "sim/case/muscle.h"

namespace condyle {

/// peck: cosine of the fibre length, force at once with excitation, a little damping; no effect of
/// speed (Peck 2000, Hannam 2008). hill: force falls when shortening and rises when lengthening,
/// and activation follows excitation with a delay. The passive force is the same in both: linear
/// from the optimal length to the longest.
enum class MuscleLaw { peck, hill };

struct MuscleLawSettings {
  MuscleLaw law = MuscleLaw::hill;
  double damping_N_s_mm = 0.001;  // along the line, both laws
  double fastest_per_s = 10;      // Hill: shortening without load, optimal fibre lengths a second
  double curvature = 0.25;        // Hill: a / F_max of the hyperbola
  double lengthening = 1.4;       // Hill: largest force when lengthening, of the isometric one
  double width = 0.45;            // Hill: of the bell of force by fibre length, squared
  double activate_s = 0.015, deactivate_s = 0.05;  // Hill: time constants
};

/// Tension along a muscle: active_N at full activation. Pulls when positive.
struct MuscleTension {
  double active_N = 0;
  double passive_N = 0;
  double slope_N_s_mm = 0;  // of both together by lengthening speed, at the activation asked for
  double at(double activation) const {
    const double sum = activation * active_N + passive_N;
    return sum > 0 ? sum : 0;
  }
};

/// At a length and lengthening speed.
MuscleTension muscle_tension(const Muscle& muscle, const MuscleLawSettings& settings,
                             double activation, double length_mm, double speed_mm_s);

/// Activation after a step with an excitation held; the excitation itself under the Peck law.
double next_activation(const MuscleLawSettings& settings, double activation, double excitation,
                       double step_s);

}  // namespace condyle
