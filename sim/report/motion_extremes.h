#pragma once

#include <string>
#include <vector>

#include "sim/report/motion_series.h"

namespace condyle {

/// The maximum of a measure over a motion, and its time.
struct Extreme {
  std::string name, unit;
  double value = 0, time_s = 0;
};

/// Maxima of all measures, counted from rest: opening, closing beyond rest, interincisal distance,
/// protrusion, posterior displacement of the incisors (part of opening), laterotrusion to either
/// side, midline deviation, rotation, condylar travel and its asymmetry, speeds of opening, of
/// closing and of the incisal point. Empty for a motion without frames.
std::vector<Extreme> extremes(const MotionSeries& series);

/// The extreme of that name. throws: std::out_of_range.
const Extreme& extreme(const std::vector<Extreme>& all, const std::string& name);

}  // namespace condyle
