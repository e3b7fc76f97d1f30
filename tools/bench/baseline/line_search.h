#pragma once

#include <functional>

namespace condyle {

/// A point on a line, its value and, if requested, the slope there.
struct LinePoint {
  double t = 0, value = 0, slope = 0;
};

struct LineSettings {
  double first_step = 1;   // first trial; above 0
  double greatest = 1e30;  // no t beyond this
  double tolerance = 0.1;  // width of the last interval over t
  int max_evaluations = 60;
  bool both_sides = false;  // the minimum may lie at t < 0
};

/// Minimum along a line by values alone: brackets it, then fits parabolas (Brent's method). Values
/// may be infinite. `start` is t = 0 with its value, and its slope, or 0 where that is unknown.
/// Returns `start` when nothing lower is found.
LinePoint search_by_parabolas(const std::function<double(double)>& value, const LinePoint& start,
                              const LineSettings& settings);

/// The same by values and slopes: brackets the change of the slope's sign, then takes secants of
/// it. `start` has a slope below zero.
LinePoint search_by_slopes(const std::function<LinePoint(double)>& value_and_slope,
                           const LinePoint& start, const LineSettings& settings);

}  // namespace condyle
