#pragma once

#include <string>
#include <vector>

#include "sim/simulator/simulator.h"

namespace condyle {

/// What one pair of bones did along a motion.
struct PairVerdict {
  std::string a, b;
  bool teeth = false;  // both are teeth: they are meant to meet, so no margin applies
  double rest_distance_mm = 0, rest_depth_mm = 0;
  double least_distance_mm = 0;
  int least_frame = 0;
  double beyond_rest_mm = 0;  // deepest penetration more than at rest
  int deepest_frame = 0;
  int first_touch = -1;  // frame, or -1
  int touching_frames = 0;
  bool violates_margin = false, penetrates = false;
};

struct ClearanceCheck {
  std::vector<PairVerdict> pairs;
  int frames = 0;
  std::vector<double> opening_mm, rotation_deg;  // one per frame
  std::string pairs_csv;                         // a row per pair and frame

  bool violated() const;
  std::string json(const Scene& scene, const Motion& motion, double margin_mm) const;
  std::string text(double margin_mm) const;
};

/// Walks the motion as it is wanted, without stopping at contacts, and tells where bones meet.
ClearanceCheck check_clearance(const Scene& scene, const Motion& motion, double margin_mm,
                               const SimulatorSettings& settings, const Progress& progress = {});

}  // namespace condyle
