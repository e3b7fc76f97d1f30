#pragma once

#include <string>
#include <vector>

#include "sim/report/motion_series.h"

namespace condyle {

/// A measured quantity beside what is accepted in healthy adults and what was published.
struct Finding {
  std::string name, unit;
  double value = 0;
  double low = 0, high = 0;  // accepted band; low > high: none
  std::string published;
  bool input = false;    // was put in: finding it again proves nothing
  std::string why = {};  // what to think of when it lies outside

  bool banded() const { return low <= high; }
  bool within() const { return !banded() || (value >= low && value <= high); }
};

/// Fewer than 20 frames a second do not show what happens within a phase.
bool too_coarse(const MotionSeries& series);

/// What the motion did, phase by phase, as it was simulated: inputs marked, all else emerged from
/// joints and teeth. Nothing without landmarks or a mandible; only what the widest frame shows
/// where frames are too coarse.
std::vector<Finding> findings(const Scene& scene, const Motion& motion, const MotionSeries& series);

/// What no healthy jaw does, or what counts as impaired, in sentences.
std::vector<std::string> physiology_warnings(const MotionSeries& series);

/// Area inside a closed line seen from the front, mm2.
double frontal_area(const std::vector<Eigen::Vector3d>& points);

}  // namespace condyle
