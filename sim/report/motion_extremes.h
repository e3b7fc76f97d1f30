#pragma once

#include <string>
#include <vector>

#include "sim/report/motion_series.h"

namespace condyle {

/// The largest of a measure over a motion, and when.
struct Extreme {
  std::string name, unit;
  double value = 0, time_s = 0;
};

/// Of every measure, from rest: opening, closing beyond rest, between the incisors, protrusion,
/// the incisors' way back (opening takes them there), laterotrusion to either side, midline
/// deviation, rotation, condyles' travel, their difference (asymmetry), speeds of opening and
/// closing and of the incisal point. A motion without frames has none.
std::vector<Extreme> extremes(const MotionSeries& series);

/// The one called so. throws: std::out_of_range.
const Extreme& extreme(const std::vector<Extreme>& all, const std::string& name);

}  // namespace condyle
