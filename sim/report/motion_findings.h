#pragma once

#include <string>
#include <vector>

#include "sim/report/motion_series.h"

namespace condyle {

/// A measured quantity with its reference range in healthy adults and its published values.
struct Finding {
  std::string name, unit;
  double value = 0;
  double low = 0, high = 0;  // reference range; low > high: none
  std::string published;
  // Prescribed by the user or the program, or a consequence of that in any anatomy: no evidence.
  bool input = false;
  std::string why = {};  // likely cause of a value outside the range

  bool banded() const { return low <= high; }
  bool within() const { return !banded() || (value >= low && value <= high); }
};

/// Whether the series has fewer than 20 frames a second, too few to resolve a phase.
bool too_coarse(const MotionSeries& series);

/// Findings of the simulated motion, phase by phase. Inputs are marked; all other quantities emerge
/// from joints and teeth: they would differ in another anatomy. Empty without landmarks or a
/// mandible; limited to the frame of largest opening where the series is too coarse.
std::vector<Finding> findings(const Scene& scene, const Motion& motion, const MotionSeries& series);

/// Sentences on measures outside the range of healthy jaws.
std::vector<std::string> physiology_warnings(const MotionSeries& series);

/// Area enclosed by a closed line in the frontal plane, mm2.
double frontal_area(const std::vector<Eigen::Vector3d>& points);

}  // namespace condyle
